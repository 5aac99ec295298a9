"""Whether the time is in the unit that it is read in."""

from __future__ import annotations

from collections.abc import Iterator

from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures

_UNITS = {0: "s", -3: "ms", -6: "us", -9: "ns"}
"""Power of ten of a second → unit."""
_MINUTE = 60.0
MATCHES = 0.01
"""A ratio is that of two units if it is so within a hundredth: chance hits one of them in one case of a few dozen."""
_LONGEST, _SHORTEST = 0.1, 5e-6
"""Seconds between two samples: friction at reversals does not show at fewer than ten samples a second, and no drive is
recorded at more than some hundred thousand."""
_FAR = 1000.0
"""Times beyond that a unit is likelier than such a recording."""


def is_of_minutes(scale: float) -> bool:
    """Whether a rate in a second is that share of the change of its quantity in what was taken for one."""
    return abs(_MINUTE * scale - 1.0) < MATCHES


def far_off(log: Log) -> Iterator[Finding]:
    """Say that samples are a thousand times farther apart than any drive's, or nearer, where one unit mends it."""
    interval = log.recording.interval
    if _SHORTEST / _FAR <= interval < _LONGEST * _FAR:
        return
    now = next((p for p, unit in _UNITS.items() if unit == log.column("time")[1]), 0)
    fitting = [unit for p, unit in _UNITS.items() if _SHORTEST <= interval * 10.0 ** (p - now) < _LONGEST]
    if len(fitting) == 1:
        yield Finding(
            "unit",
            Severity.WARN,
            "time",
            f"from sample to sample it is {figures(interval, 3)} s as the {log.called('time')} is read",
            f"if it is in {fitting[0]} say so, as in {log.option('time', fitting[0])}",
        )


def other_unit(log: Log, power: int) -> str:
    """Return the unit in which the time may be where its steps are so many powers of ten too long; empty if in none.

    The steps must be such as no drive is recorded with, and must be sensible in that unit.
    """
    interval = log.recording.interval
    now = next((p for p, unit in _UNITS.items() if unit == log.column("time")[1]), 0)
    unit = _UNITS.get(now - power, "")
    if not power or not unit or _SHORTEST <= interval < _LONGEST:
        return ""
    return unit if _SHORTEST <= interval / 10.0**power < _LONGEST else ""


def in_unit(log: Log, unit: str, why: str) -> Finding:
    """Return the finding that the time is in another unit, with what else speaks for it."""
    return Finding(
        "unit",
        Severity.STOP,
        "time",
        f"the {log.called('time')} seems to be in {unit}: {why}, and from sample to sample it is "
        f"{figures(log.recording.interval, 3)} s as it is read",
        f"give the unit, as in {log.option('time', unit)}",
    )
