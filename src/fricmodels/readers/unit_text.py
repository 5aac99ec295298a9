"""What may stand in a unit before it is worked out: a unit is arithmetic, and arithmetic can take for ever.

A unit is names and plain numbers, multiplied and divided, each with a small exponent that is a plain number.
"""

from __future__ import annotations

import re

_LONGEST = 80
_GREATEST_EXPONENT = 12.0
_NUMBER = r"(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[eE][-+]?\d{1,3})?"
_RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
_TOKEN = re.compile(
    rf"""\s*(?:
      (?P<raised>[⁻⁺]?[{_RAISED}]{{1,2}}(?![{_RAISED}⁻⁺]))
    | (?:\*\*|\^)\s*(?P<exponent>[-+]?{_NUMBER}(?![\w.])|\(\s*[-+]?{_NUMBER}\s*(?:/\s*{_NUMBER}\s*)?\))
    | (?P<number>{_NUMBER})
    | (?P<name>[^\W\d{_RAISED}][^\W{_RAISED}]*|[°%‰′″Ω℃℉Å])
    | (?P<sign>\*(?!\s*\*)|[/·×⋅-])
    | (?P<bracket>[()])
    )""",
    re.VERBOSE,
)


def is_plain(unit: str) -> bool:
    """Whether a text is built like a unit and can be worked out at once."""
    if len(unit) > _LONGEST:
        return False
    position, depth, before = 0, 0, ""
    text = unit.strip()
    while position < len(text):
        found = _TOKEN.match(text, position)
        if found is None:
            return False
        kind = str(found.lastgroup)
        if kind in ("raised", "exponent") and (before in ("", "raised", "exponent", "sign") or not _small(found[kind])):
            return False
        if kind == "bracket":
            depth += 1 if found[kind] == "(" else -1
            if depth not in (0, 1, 2, 3):
                return False
        position, before = found.end(), kind
    return depth == 0


def _small(exponent: str) -> bool:
    above, _, below = exponent.translate(_SUPERSCRIPTS).strip("() ").partition("/")
    divisor = float(below) if below else 1.0
    return divisor != 0.0 and abs(float(above) / divisor) <= _GREATEST_EXPONENT
