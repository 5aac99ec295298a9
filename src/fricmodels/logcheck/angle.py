"""Whether angles are in radians, from the position itself and from what the torque does over a turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.logcheck.balance import Balance, Cells
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.rates import link
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.clusters import significance, slope

_SPEEDS = {"deg": "deg/s", "turn": "turn/s", "rpm": "rpm"}
_ROUNDING = 1e-20
"""Share of the torque's square below which what is left is rounding."""
_TURN = {"deg": 360.0, "turn": 1.0}
_FEWEST_COUNTS = 8
"""Steps over which a position goes at least before it is said to be counts."""


def wrapped(log: Log) -> Iterator[Finding]:
    """Say that a position was unwrapped; one that jumps by 360 is in degrees, and that stops."""
    known = log.recording.provenance.get("unwrapped")
    if not known:
        return
    period, jumps, name = known["period"], known["jumps"], known["name"]
    count = f"{jumps} jump{'s' if jumps > 1 else ''}"
    if log.rotary and name in ("360", "180"):
        yield Finding(
            "unit",
            Severity.STOP,
            "position",
            f"the {log.called('position')} jumps by {period:g}, so that it is in degrees, and is taken for radians",
            f"give the unit, as in {log.option('position', 'deg')}",
        )
    yield Finding(
        "wrapped-position",
        Severity.WARN,
        "position",
        f"the {log.called('position')} was wrapped at {figures(period, 6)} {log.length_unit} ({name}); it was "
        f"unwrapped at "
        f"{count}",
    )


def grid(log: Log) -> Iterator[Finding]:
    r"""Judge the unit by the encoder: a turn has a whole number of steps, and mostly a round one.

    The step q of the position is known to :math:`q/n` over a range of n steps. It divides :math:`2\pi`, 360 or 1 into
    N parts; N is round where it is a power of two, or 1, 2, 3, 5 times powers of two and ten, times four. Degrees are
    found where :math:`360/q` is such a number within its error and :math:`2\pi/q` is not. Steps of two significant
    digits are those of a rounded number, and say nothing.
    """
    if not log.rotary or "position" not in log.measured:
        return
    step = log.resolution["position"]
    values = log.short.recording["position"]
    if step <= 0.0 or _decimal(step):
        return
    exact = _refined(values, step)
    if exact is None:
        return
    value, error = exact
    found = {unit: turn / value for unit, turn in {"rad": 2.0 * math.pi, **_TURN}.items()}
    is_round = {unit: _round(number, number * error / value) for unit, number in found.items()}
    if is_round["deg"] and not is_round["rad"]:
        goes_with = link(log.short, values, log.short.velocity) if "velocity" in log.measured else None
        others = ["velocity"] if goes_with is not None and goes_with.may_hold else []
        yield Finding(
            "unit",
            Severity.STOP,
            "position",
            f"the {log.called('position')} comes in steps of {figures(value, 6)}, which is 360/{found['deg']:.0f}: "
            f"it is in degrees, and is taken for radians",
            "give the unit, as in "
            + " ".join([log.option("position", "deg"), *(log.option(other, "deg/s") for other in others)]),
        )


def counts(log: Log) -> Iterator[Finding]:
    """Say where a position is whole numbers: no encoder has steps of one radian or metre, but counts are such."""
    if "position" not in log.measured or log.resolution["position"] != 1.0:
        return
    values = log.short.recording["position"]
    if np.any(values != np.round(values)) or float(np.ptp(values)) < _FEWEST_COUNTS:
        return
    unit, one = ("radians", "count/4096") if log.rotary else ("metres", "1e-6 m")
    yield Finding(
        "unit",
        Severity.WARN,
        "position",
        f"the {log.called('position')} is whole numbers, as counts of an encoder are, and is taken for {unit}",
        f"say how much one is of your encoder, as in {log.option('position', one)}",
    )


def _decimal(step: float) -> bool:
    """Whether a step has two significant digits, as a rounded number has: such a one says nothing of a turn."""
    tens = 10.0 * step / 10.0 ** math.floor(math.log10(step) + 1e-6)
    return abs(tens - round(tens)) < 1e-4 * tens


def _refined(values: Array, step: float) -> tuple[float, float] | None:
    """Return the step of a grid and its error, from counts over the whole range."""
    offset = float(values[0])
    distinct = np.unique(values) - offset
    if len(distinct) < 8:
        return None
    for _ in range(3):
        near = np.abs(distinct) * 0.02 < step * max(1.0, 0.02 * step / _spread(distinct, step))
        number = np.round(distinct / step)
        used = near & (number != 0)
        if np.count_nonzero(used) < 4:
            return None
        step = float(number[used] @ distinct[used]) / float(number[used] @ number[used])
    number = np.round(distinct / step)
    left = distinct - step * number
    rms = float(np.sqrt(np.mean(left**2)))
    if rms > 0.1 * step:
        return None
    largest = float(np.abs(number).max())
    return step, max(rms, 1e-9 * step) / largest


def _spread(distinct: Array, step: float) -> float:
    left = distinct - step * np.round(distinct / step)
    return max(float(np.sqrt(np.mean(left**2))), 1e-12 * step)


def _round(number: float, error: float) -> bool:
    whole = round(number)
    if whole < 8 or abs(number - whole) > max(3.0 * error, 1e-6 * number) or 3.0 * error > 0.02:
        return False
    for prime in (2, 5, 3):
        limit = 1 if prime == 3 else 64
        while whole % prime == 0 and limit:
            whole //= prime
            limit -= 1
    return whole == 1


def periods(log: Log, found: Balance) -> Iterator[Finding]:
    r"""Judge the unit by what the torque does over a turn: gravity repeats after :math:`2\pi`, not after 360 or 60.

    The sine and cosine of the position are exchanged for those with a turn of 360 (degrees), 60 (rpm, integrated) or 1.
    A unit may be found where that leaves less than a quarter of what was left, and where the least over turns of
    :math:`2^{-3/4} \ldots 2^{3/4}` times as much is within a twentieth: the torque's period over a gear of any ratio
    would be there in one case of ten. A turn a quarter shorter or longer must leave more, by squares in pairs over 32
    clusters, at a level of a hundredth each. That is a question, no proof. Nothing is asked where the balance leaves
    no more than rounding: what is constant repeats after any angle.
    """
    if not log.rotary or "sine" not in found.names:
        return
    if np.mean(found.left**2) <= _ROUNDING * np.mean(found.target**2):
        return
    turns = {"deg": 360.0, "turn": 1.0} if "position" in log.measured else {"deg": 360.0, "rpm": 60.0, "turn": 1.0}
    position = log.short.position
    kept = [j for j, name in enumerate(found.names) if name not in ("sine", "cosine")]
    cells = Cells.of(log.short, found.width)

    def left(turn: float) -> Array:
        angle = 2.0 * math.pi / turn * position
        waves = [cells.mean(np.sin(angle)), cells.mean(np.cos(angle))]
        columns = np.column_stack([found.columns[:, kept], *waves])
        columns = columns / np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
        rest = found.target - columns @ np.linalg.lstsq(columns, found.target, rcond=1e-10)[0]
        return np.asarray(rest**2)

    for unit, turn in turns.items():
        here = left(turn)
        if np.mean(here) > 0.25 * np.mean(found.left**2):
            continue
        factors = np.exp2(np.linspace(-0.75, 0.75, 37))
        least = factors[np.argmin([np.mean(left(turn * factor)) for factor in factors])]
        if abs(least - 1.0) > 0.05 or not all(_less(here, left(turn * f), found.cluster) for f in (0.8, 1.25)):
            continue
        channels = {"velocity": _SPEEDS[unit], "position": unit}
        options = [log.option(name, as_unit) for name, as_unit in channels.items() if name in log.measured]
        channel = "position" if "position" in log.measured else "velocity"
        yield Finding(
            "unit",
            Severity.WARN,
            channel,
            f"the torque repeats after {turn:g}, as gravity over a turn, and not after 6.283: the "
            f"{log.called(channel)} may be in {channels[channel]}, and is taken for radians",
            "if so give the unit, as in " + " ".join(options),
        )
        return


def _less(one: Array, other: Array, cluster: Index) -> bool:
    difference, ones = other - one, np.ones(len(one))
    value, error, count = slope(difference, ones, cluster)
    return value > 0.0 and significance(value / error, count) < 0.01
