"""Units that stand in the name of a column: ``Speed [rpm]``, ``pos_deg``, ``i (mA)``."""

from __future__ import annotations

import re

from fricmodels.errors import InputError
from fricmodels.readers import units

_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]\s*$")
_SUFFIXES = {
    "rad_s2": "rad/s^2",
    "rads2": "rad/s^2",
    "deg_s2": "deg/s^2",
    "m_s2": "m/s^2",
    "rad_s": "rad/s",
    "rads": "rad/s",
    "radps": "rad/s",
    "deg_s": "deg/s",
    "degs": "deg/s",
    "degps": "deg/s",
    "dps": "deg/s",
    "m_s": "m/s",
    "mm_s": "mm/s",
    "rpm": "rpm",
    "rad": "rad",
    "deg": "deg",
    "mm": "mm",
    "Nm": "N*m",
    "mNm": "mN*m",
    "kN": "kN",
    "mA": "mA",
    "mV": "mV",
    "ms": "ms",
    "us": "us",
    "ns": "ns",
    "V": "V",
    "A": "A",
}
"""End of a column's name after an underscore → unit. Those of several letters may be in any case but for capitals that
tell two units apart. Single letters that are often something else (``q_m`` of the motor, ``x_s``) are left out."""
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
_NAMED_TORQUE = re.compile(r"(^|[_\W])(torque|tau|trq|tq|effort|force|moment)", re.IGNORECASE)


def stated_unit(column: str, channel: str) -> str | None:
    """Return the unit that a column's name states, or ``None``.

    In brackets it may be any unit that is known; after an underscore, one of a list. What does not measure the channel
    is no unit of it, but for a voltage or a current in place of a torque: those it must not be taken for.

    Raises:
        InputError: where the brackets state counts or a share, whose size nobody can know.
    """
    found = _BRACKETS.search(column)
    if found is not None:
        written = found[1].replace("²", "^2").replace("·", "*").replace("°", "deg").replace("N m", "N*m")
        if _usable(written, channel) and not written.isdigit():
            return written
        if _SIZELESS.fullmatch(written):
            example = _EXAMPLES.get(channel, "0.001 " + ("s" if channel == "time" else "rad/s"))
            raise InputError(
                f"the column '{column}' is in '{found[1]}', which has no size; say how much one is, "
                f"as in --column '{channel}={column}:{example}'{_OF_A_LENGTH.get(channel, '')}"
            )
        return None
    for end, unit in _SUFFIXES.items():
        tail = column[-len(end) :]
        if not column[: -len(end)].endswith("_") or (tail != end if end != end.lower() else tail.lower() != end):
            continue
        if unit in ("V", "A") and _NAMED_TORQUE.search(column):
            return None  # torque_A is that of an axis A, or phase A
        return unit if _usable(unit, channel) else None
    return None


def without_unit(column: str) -> str:
    """Return a column's name without a unit at its end, in brackets or after an underscore."""
    found = _BRACKETS.search(column)
    ends = [len(end) + 1 for end in _SUFFIXES if column.lower().endswith("_" + end.lower())]
    return column[: found.start() if found else len(column) - max(ends, default=0)].rstrip()


def _usable(unit: str, channel: str) -> bool:
    if not units.known(unit):
        return False
    if channel in ("torque", "load_torque") and (units.is_current(unit) or units.is_voltage(unit)):
        return True
    return bool(units.fits(unit, channel))
