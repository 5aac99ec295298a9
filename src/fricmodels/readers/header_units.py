"""Units that stand in the name of a column: ``Speed [rpm]``, ``pos_deg``, ``i (mA)``, ``M/mNm``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product

from fricmodels.errors import InputError
from fricmodels.readers import units
from fricmodels.readers.dates import states_order
from fricmodels.recording import OTHER

_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]\s*$")
_OVER = re.compile(r"^([^/]*[^/\s])\s*/\s*([^/\s].*)$")
"""A quantity over its unit (DIN 1313)."""
_LENGTHS = {
    **{name: name for name in ("rad", "mrad", "urad", "deg", "mdeg", "arcmin", "arcsec", "mm", "cm", "um", "nm")},
    "inch": "in",
    "inches": "in",
    "rev": "turn",
    "revs": "turn",
    "turn": "turn",
    "turns": "turn",
}
"""Angles and lengths at the end of a name."""
_OVER_TIME = {"_s": "/s", "/s": "/s", "_per_s": "/s", "ps": "/s", "_s2": "/s^2", "/s2": "/s^2", "/s^2": "/s^2"}
_ANGLES_OVER_TIME = {**_OVER_TIME, "s": "/s", "s2": "/s^2"}
_ARMS = {
    "lb": ("in", "ft"),
    "lbf": ("in", "ft"),
    "oz": ("in", "ft"),
    "ozf": ("in", "ft"),
    "kg": ("cm",),
    "kgf": ("cm",),
}
_FORCES = {"lb": "lbf", "oz": "ozf", "kg": "kgf"}


def _endings() -> dict[str, str]:
    found = dict(_LENGTHS)
    for end, unit in {**_LENGTHS, "m": "m"}.items():
        times = _ANGLES_OVER_TIME if unit.endswith(("rad", "deg")) else _OVER_TIME
        found |= {end + over: unit + rate for over, rate in times.items()}
    for force, arms in _ARMS.items():
        for arm, between in product(arms, ("", "_", "-")):
            torque = f"{_FORCES.get(force, force)}*{arm}"
            found |= {f"{force}{between}{arm}": torque, f"{arm}{between}{force}": torque}
    return found


_SUFFIXES = {
    **_endings(),
    **dict.fromkeys(("rpm", "rev_min", "rev_per_min", "rev/min", "u_min"), "rpm"),
    "dps": "deg/s",
    "rps": "turn/s",
    "NM": "N*m",
    "Nm": "N*m",
    "mNm": "mN*m",
    "cNm": "cN*m",
    "Ncm": "N*cm",
    "Nmm": "N*mm",
    "kNm": "kN*m",
    **{name: name for name in ("kN", "mA", "mV", "ms", "us", "ns", "V", "A")},
}
"""End of a column's name after an underscore → unit. Those of several letters may be in any case but for capitals that
tell two units apart. Single letters that are often something else (``q_m`` of the motor, ``x_s``) are left out."""
_OF_ANGLES = frozenset({"deg", "mdeg", "rad", "mrad", "rpm", "deg/s", "rad/s", "mrad/s", "turn/s"})
"""Units at the end of a name that are nothing else there."""
_SIZELESS = re.compile(
    r"""[\d.,]*\s*(
        (cnts?|counts?|incs?|increments?|ticks?|pulses?|steps?|lsb|digits?|raw|bits?)(\s*/\s*\w+)?
        | %|‰|percent|per\s?mille?|permille?|p\.?u\.?
    )""",
    re.IGNORECASE | re.VERBOSE,
)
"""What a header calls a unit, and has no size that anybody could know."""
_EXAMPLES = {"torque": "0.0024 N*m", "load_torque": "0.0024 N*m", "current": "0.0024 A", "position": "count/4096"}
_OF_A_LENGTH = {"position": " for 4096 a turn, or 0.001 mm on a linear axis"}
_INDEX = re.compile(r"[\d\s,:;]+")
"""``q [0]``: a place in a vector or a matrix."""
_NOTES = re.compile(
    r"""(measured|meas|actual|act|raw|filtered|filt|smoothed|estimated|est|estimate|calculated|calc|derived|simulated|
    ist|motor|motor\s?side|joint|joint\s?side|link|link\s?side|load|load\s?side|output|input|drive|axis|encoder|
    sensor|left|right|arm|main|feedback|fbk|utc|gmt|local|iso|iso\s?8601|h+:mm?:ss?(\.\w+)?|clock|abs|absolute|
    relative|rel|value|signal|channel|ch|phase|\s|_|-|\d)+""",
    re.IGNORECASE | re.VERBOSE,
)
"""What stands in brackets in a header and is no unit."""
_WORDS = re.compile(r"[^\W_][\w ]*")
_NAMED_TORQUE = re.compile(r"(^|[_\W])(torque|tau|trq|tq|effort|force|moment)", re.IGNORECASE)


class NoUnit(InputError):
    """What stands in the brackets of a header is no unit of its channel."""


def stated_unit(column: str, channel: str) -> str | None:
    """Return the unit that a column's name states, or ``None``.

    In brackets or behind a stroke it may be any unit that is known; after an underscore, one of a list. What stands
    after an underscore or a stroke and does not measure the channel is no unit of it, but for a voltage or a current in
    place of a torque: those it must not be taken for.

    Raises:
        InputError: where the brackets state counts or a share, whose size nobody can know.
        NoUnit: where they state what is no unit of the channel, and neither an index nor words (:func:`doubtful`).
    """
    found = _BRACKETS.search(column)
    if found is not None:
        written = found[1].replace("²", "^2").replace("·", "*").replace("°", "deg").replace("N m", "N*m")
        if _usable(written, channel) and not written.isdigit():
            return written
        if channel.startswith(OTHER):
            return None
        if _SIZELESS.fullmatch(written):
            example = _EXAMPLES.get(channel, "0.001 " + ("s" if channel == "time" else "rad/s"))
            raise InputError(
                f"the column '{column}' is in '{found[1]}', which has no size; say how much one is, "
                f"as in --column '{channel}={column}:{example}'{_OF_A_LENGTH.get(channel, '')}"
            )
        if channel == "time" and states_order(found[1]) is not None:
            return None
        if _INDEX.fullmatch(written) or _NOTES.fullmatch(written) or doubtful(column):
            return None
        why = "does not measure it" if units.known(written) else "is not known"
        what = channel.replace("_", " ")
        raise NoUnit(
            f"the column '{column}' of the {what} states the unit '{found[1]}', which {why}; "
            f"give the unit, as in --column '{channel}={column}:UNIT'"
        )
    for unit in (*_after_underscore(column), *_behind_stroke(column)):
        if unit in ("V", "A") and _NAMED_TORQUE.search(column):
            return None  # torque_A is that of an axis A, or phase A
        if _usable(unit, channel):
            return unit
    return None


def stated_size(column: str, channel: str) -> str | None:
    """Return :func:`stated_unit`, or ``None`` for counts and shares: their size is asked for where they are mapped."""
    try:
        return stated_unit(column, channel)
    except InputError:
        return None


def _after_underscore(column: str) -> Iterator[str]:
    """Yield the units that the end of a name may be: ``NM`` is that of a torque, and also of a very small length."""
    for end, unit in _SUFFIXES.items():
        tail = column[-len(end) :]
        any_case = end == end.lower()
        if column[: -len(end)].endswith("_") and (tail.lower() if any_case else tail) == end:
            yield unit


def _behind_stroke(column: str) -> Iterator[str]:
    """Yield what a quantity is divided by, as it is written."""
    found = _OVER.match(column)
    if found is not None:
        yield found[2].replace("°", "deg")


def doubtful(column: str) -> str | None:
    """Return the words in round brackets at the end of a name, where they may be a unit that is not known."""
    found = _BRACKETS.search(column)
    if found is None or found[0][0] != "(" or not _WORDS.fullmatch(found[1]):
        return None
    plain = _INDEX.fullmatch(found[1]) or _NOTES.fullmatch(found[1]) or _SIZELESS.fullmatch(found[1])
    return None if plain or units.known(found[1]) else found[1]


def contradicting(column: str, channel: str) -> str | None:
    """Return the unit of an angle that a name ends in after an underscore, where it does not measure the channel."""
    ends = [unit for unit in _after_underscore(column) if unit in _OF_ANGLES]
    return ends[0] if ends and stated_unit(column, channel) is None and channel not in ("time", "run") else None


def may_measure(column: str, channel: str) -> bool:
    """Whether a column may be a channel by the unit in brackets at the end of its name; without one it may."""
    found = _BRACKETS.search(column)
    if found is None or any(words.fullmatch(found[1]) for words in (_SIZELESS, _INDEX)) or not units.known(found[1]):
        return True
    return _usable(found[1], channel)


def without_unit(column: str) -> str:
    """Return a column's name without a unit at its end, in brackets, after an underscore or behind a stroke."""
    found = _BRACKETS.search(column)
    over = _OVER.match(column)
    if found is None and over is not None and units.known(over[2]):
        return over[1]
    ends = [len(end) + 1 for end in _SUFFIXES if column.lower().endswith("_" + end.lower())]
    return column[: found.start() if found else len(column) - max(ends, default=0)].rstrip()


def _usable(unit: str, channel: str) -> bool:
    if not units.known(unit) or channel.startswith(OTHER):
        return False
    if channel in ("torque", "load_torque") and (units.is_current(unit) or units.is_voltage(unit)):
        return True
    return bool(units.fits(unit, channel))
