"""How units are spelled in the headers of logs, and what Pint calls them.

``rev`` and ``Umdr`` are turns, ``U/min`` and ``1/min`` turns a minute, ``kp`` is a kilogram-force, ``dps`` are degrees
a second, ``cnt`` and ``inc`` counts, a full stop, a dash or any dot between two units multiplies them, ``lb-in``,
``kg.cm`` and ``Newtonmeter`` are torques, and a capital letter more or less changes no ``RPM``.
"""

from __future__ import annotations

import re

_ABBREVIATED = re.compile(r"^[^.]*[^\W\d_]\.$")
_LONGEST = 80
"""Longer texts are no units."""
_TURNS = re.compile(r"(?<![^\W\d_])(m?)(?i:revs?|umdr|umdrehung(?:en)?)(?:\.(?!\s*[^\W\d_]))?(?![^\W\d_])")
"""Turns wherever they stand, or thousandths of them."""
_TURNS_IN_A_TIME = re.compile(r"(?<![^\W\d_])(U|r|tr|giri|об)\.?(?=\s*/\s*(min|sec|s|мин)(?![^\W\d_²³]))")
"""What is a turn only over a time."""
_WORDS = {
    "upm": "rpm",
    "r.p.m.": "rpm",
    "u.p.m.": "rpm",
    "ncm": "N*cm",
    "nmm": "N*mm",
    "inlb": "in*lbf",
    "lbin": "lbf*in",
    "ftlb": "ft*lbf",
    "lbft": "lbf*ft",
    "ozin": "ozf*in",
    "inoz": "in*ozf",
    "kgcm": "kgf*cm",
    "kgfcm": "kgf*cm",
    "kgfm": "kgf*m",
    "kpcm": "kgf*cm",
    "kpm": "kgf*m",
    "mmps": "mm/s",
    "mps": "m/s",
}
"""Whole texts, in small letters."""
_ANY_CASE = re.compile(
    r"(?<![^\W\d_])(rpm|rps|deg|degrees?|rad|radians?|sec|seconds?|min|minutes?|turns?|counts?|inch(?:es)?|newtons?|amperes?)(?![^\W\d_])",
    re.IGNORECASE,
)
_NAMES = {
    "kp": "kgf",
    "Grad": "deg",
    "мин": "min",
    "lbs": "lb",
    "NM": "Nm",
    "dps": "deg/s",
    "DPS": "deg/s",
    "mdps": "mdeg/s",
    "amps": "A",
    "Amps": "A",
    "Amp": "A",
    "Sek": "s",
    "Sekunden": "s",
    **dict.fromkeys(("cnt", "cnts", "inc", "incs"), "count"),
}
_NEWTON_METRES = re.compile(r"(?<![^\W\d_])(milli|kilo)?newtons?[\s*·._-]*met(?:er|re)s?(?![^\W\d_])", re.IGNORECASE)
_PREFIXES = {"milli": "m", "kilo": "k"}
_NAME = re.compile(r"[^\W\d_]+")
_PRODUCT = re.compile(r"(?<=[^\W\d_])\s*[.-]\s*(?=[^\W\d_])")
_POWER = re.compile(r"(?<=[^\W\d_])(?<!\d[eE])-(?=\d{1,2}(?!\d))")


_DOTS = str.maketrans(dict.fromkeys("・･∙•‧", "·"))
"""Dots of other scripts and keyboards that stand for a product."""


def spelled(unit: str) -> str:
    """Return a unit as Pint spells it; what is spelled otherwise stays."""
    if len(unit) > _LONGEST:
        return unit
    text = unit.strip()
    text = text[:-1] if _ABBREVIATED.search(text) else text
    word = _WORDS.get(text.lower())
    if word is not None and not text.startswith("M"):
        return word
    text = _TURNS_IN_A_TIME.sub("turn", _TURNS.sub(r"\1turn", text.replace("º", "°").translate(_DOTS)))
    text = _ANY_CASE.sub(lambda found: found[0].lower(), text)
    text = _NEWTON_METRES.sub(lambda found: _PREFIXES.get((found[1] or "").lower(), "") + "Nm", text)
    text = _NAME.sub(lambda found: _NAMES.get(found[0], found[0]), text)
    return _POWER.sub("^-", _PRODUCT.sub("*", text))
