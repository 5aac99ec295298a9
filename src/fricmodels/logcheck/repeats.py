"""Whether each sample is a new one: values that were polled less often than logged, and values that were lost."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.moving import moving
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.clusters import LEVEL
from fricmodels.signals.noise_level import noise, quantum
from fricmodels.signals.switched import is_switched

_NEAR = 8
"""Samples on each side from which the usual change is taken."""
_STEPS = 4.0
"""Steps of the grid by which a channel changes from sample to sample where a repeated value is no rounding."""
_BLOCK = 512
_FEWEST = 3
"""Stretches that tell of lost values: one or two may be a drive that was switched off."""
_SHORTEST = 2
"""Repetitions in succession: single ones are counted otherwise."""
_MOST = 0.5
"""Share of the samples in motion up to which values are lost ones, and no command in steps."""
_FRESH = 0.5
"""Chance to repeat from which a channel is too coarse to tell lost values from others."""
_AS_EVER = 0.25
"""Share of the usual change that the change before a lost value has at least, as a rule."""
_JUMP = 3.0
"""Times the usual change by which a smooth channel jumps after lost values, and not before."""
_AGAIN = 0.1
"""Share of the stretches above which a value stands for something."""


def repeated(log: Log) -> Iterator[Finding]:
    """Judge whether values stand still while the channel changes: polled less often than logged, or lost samples.

    Looked at is where a channel changes by four steps of its grid or more from sample to sample, on the average over
    eight samples on each side, and goes the same way on both. There an exact repetition is one value among many, and
    changes by a step, or a thirtieth of the usual change, either way are more frequent. The two counts are compared by
    the binomial test of one half. A position that was not new catches up in the next step; one that stood still does
    not, and is left out. Nor is a velocity looked at where the position goes on by as much as in the sample before: a
    drive makes its velocity of such counts, and it is the same while they are.
    """
    from scipy.special import bdtrc

    for channel, values in log.short.recording.channels.items():
        if channel not in log.measured or channel not in ("position", "velocity", "torque", "acceleration"):
            continue
        if not np.any(values[1:] == values[:-1]):
            continue
        change, usual, grid = _moving(log.short, values)
        if channel == "velocity" and "position" in log.measured:
            usual[_goes_on_alike(log.short.recording["position"])] = 0.0
        total = int(np.count_nonzero(usual))
        if channel == "position" and not _catches_up(change, usual):
            continue
        if not total:
            continue
        same = int(np.count_nonzero(change[usual > 0.0] == 0.0))
        small = int(np.count_nonzero((usual > 0.0) & (np.abs(change) <= np.maximum(1.5 * grid, usual / 30.0)))) - same
        if same <= small or bdtrc(same - 1, same + small, 0.5) >= LEVEL:
            continue
        interval = _between_new(change, usual > 0.0)
        share = 1.0 - 1.0 / interval
        often = f", a new one every {figures(interval)} samples" if share > 0.3 else ""
        yield Finding(
            "repeated-samples",
            Severity.WARN,
            channel,
            f"{figures(100 * share)} % of the samples of the {log.called(channel)} repeat the one before while it "
            f"changes{often}",
            "log each new value once" if share > 0.3 else "drop repeated samples",
        )


def polled(log: Log) -> Iterator[Finding]:
    """Say where each sample stood in several rows, and was taken once."""
    known = log.recording.provenance.get("polled")
    if known:
        rows, samples = known["rows"], known["samples"]
        share = figures(100 * (1 - samples / rows))
        taken = f"of {rows} rows {samples} are taken"
        of_all = (
            "the rows repeat the one before in all channels: the log was written more often than there were new values"
        )
        text, channel, remedy = f"{share} % of {of_all}, {taken}", "torque", "log each new value once"
        if known.get("of") == "motion":
            channels = [name for name in ("position", "velocity") if name in log.measured]
            said = f"{' and '.join(channels)} {'repeat' if len(channels) > 1 else 'repeats'} in {share} % of the rows"
            text = f"{said}, at even distances: {taken}, with the mean of the torque about each"
            channel, remedy = channels[0], "log the motion as often as the torque"
        late = "when it was new is known to a row only"
        yield Finding("repeated-samples", Severity.WARN, channel, text, f"{remedy}: {late}")


def outages(log: Log) -> Iterator[Finding]:
    """Say for how long all channels stood still together while the drive moved, and were left out."""
    known = log.recording.provenance.get("outages")
    if known:
        several = known["times"] > 1
        times = f"{known['times']} times" if several else "once"
        yield Finding(
            "repeated-samples",
            Severity.WARN,
            "time",
            f"all channels stood exactly still together {times} while the drive moved, for "
            f"{figures(1e3 * known['longest_s'])} ms{' at most' if several else ''}: values were lost, and the last "
            f"ones kept; these {known['rows']} rows are left out",
            "log without such dropouts",
        )


def held(log: Log) -> Iterator[Finding]:
    r"""Say where a channel stands exactly still again and again while the drive moves: values were lost.

    Of a channel with noise of the standard deviation σ on a grid of steps q no more than a share
    :math:`q/(\sqrt{2\pi}\,\sigma)` of the samples has the value of the one before; of a smooth one, the share that
    changes by a step or less. Single repetitions may be more frequent, and then their share counts. Looked at are
    stretches of so many equal values that none is to be expected in the recording at
    :data:`~fricmodels.signals.clusters.LEVEL`. Before them the channel must change as much as ever: what was smoothed
    comes to rest by ever smaller changes. A smooth channel must also jump after them, to where it would have been.

    Not accused are channels most of whose samples repeat (a command in steps), and values that stand for something:
    zero, the limits, and one that is held again and again.
    """
    for channel in ("torque", "velocity", "acceleration"):
        values, moves = log.measured.get(channel), moving(log, channel)
        if values is None or moves is None or np.ptp(values) == 0.0 or is_switched(values):
            continue
        first, last = _stretches(log, values, moves)
        if len(first) < _FEWEST:
            continue
        grid = float(np.median(_grid(log.short.recording[channel])))
        noisy = _is_noisy(values[moves])
        chance = (_noisy_chance if noisy else _smooth_chance)(values[moves], grid)
        chance = max(chance, np.count_nonzero(last - first == 1) / np.count_nonzero(moves))
        if chance >= _FRESH:
            continue
        least = max(int(np.ceil(np.log(LEVEL / len(values)) / np.log(chance))), _SHORTEST)
        first, last = (ends[last - first >= least] for ends in (first, last))
        if not _is_cut_off(values, moves, first, last, jumps=not noisy):
            continue
        free = ~_stands_for_something(values, values[first])
        first, last = first[free], last[free]
        samples = int((last - first).sum())
        if len(first) < _FEWEST or samples > _MOST * np.count_nonzero(moves):
            continue
        lasted = 1e3 * (log.recording.time[last] - log.recording.time[first])
        yield Finding(
            "repeated-samples",
            Severity.WARN,
            channel,
            f"the {log.called(channel)} stands exactly still {len(first)} times while the drive moves, for "
            f"{figures(float(lasted.min()))} to {figures(float(lasted.max()))} ms, "
            f"{figures(100 * samples / len(values))} % of the samples: values were lost, and the last one was kept",
            "log without such dropouts, or leave the lost values empty and read with --gaps drop",
        )


def _stretches(log: Log, values: Array, moves: Mask) -> tuple[Index, Index]:
    """Return the first and the last sample of each stretch of equal values throughout which the drive moves."""
    same = (np.diff(values) == 0.0) & log.joined
    edges = np.flatnonzero(np.diff(np.r_[0, same.astype(np.int8), 0]))
    first, last = edges[::2], edges[1::2]
    at_rest = np.r_[0, np.cumsum(~moves)]
    throughout = at_rest[last + 1] == at_rest[first]
    return first[throughout], last[throughout]


def _is_noisy(values: Array) -> bool:
    """Whether third differences change their sign more often than not: those of a smooth channel keep it."""
    third = np.diff(values, 3)
    return len(third) > 1 and float(np.mean(third[1:] * third[:-1] < 0.0)) > 0.5


def _noisy_chance(values: Array, grid: float) -> float:
    deviation = noise(np.arange(len(values), dtype=float), values)
    return grid / (np.sqrt(2.0 * np.pi) * deviation) if deviation > 0.0 else 1.0


def _smooth_chance(values: Array, grid: float) -> float:
    change = np.abs(np.diff(values))
    return float(np.mean((change > 0.0) & (change <= 1.5 * grid)))


def _is_cut_off(values: Array, moves: Mask, first: Index, last: Index, *, jumps: bool) -> bool:
    """Whether a channel changed as much as ever right before it stood still, and whether it jumps after, if it must."""
    change = np.abs(np.diff(values))
    usual = float(np.median(change[moves[1:] & (change > 0.0)]))
    before, after = change[first[first > 0] - 1], change[last[last < len(change)]]
    if not len(before) or not len(after) or np.median(before) <= _AS_EVER * usual:
        return False
    return not jumps or bool(np.median(after) > _JUMP * usual > np.median(before))


def _stands_for_something(values: Array, kept: Array) -> Mask:
    """Whether each value that is held is zero, a limit, or one of few that are held again and again."""
    _, which, times = np.unique(kept, return_inverse=True, return_counts=True)
    often = times[which] > max(2.0, _AGAIN * len(kept))
    return np.asarray((kept == 0.0) | (kept == values.min()) | (kept == values.max()) | often)


def _between_new(change: Array, looked_at: Mask) -> float:
    """Return how many samples there are from one new value to the next, on the average, about those looked at.

    Of a channel that is renewed every eighth sample or more rarely only repeated samples are looked at, since only they
    have a change on both sides: what is counted are the new values around them.
    """
    width = np.ones(2 * _NEAR + 1, dtype=np.int64)
    near = np.convolve(looked_at, width, mode="same") > 0
    new = np.flatnonzero(near & (change != 0.0))
    outside = np.r_[0, np.cumsum(~near)]
    together = outside[new[1:]] == outside[new[:-1]]
    return float(np.mean(np.diff(new)[together])) if together.any() else 1.0


def _moving(log: Log, values: Array) -> tuple[Array, Array, Array]:
    """Return the changes from sample to sample, their usual size where it is many steps of the grid, and the grid.

    The usual size is 0 where it is too few steps, or where the channel does not go on.
    """
    change = np.diff(values)
    usual, grid = np.zeros(len(change)), _grid(values)[1:]
    if len(change) < 4 * _NEAR:
        return change, usual, grid
    path = np.r_[0.0, np.cumsum(np.abs(change))]
    breaks = np.r_[0, np.cumsum(~log.joined)]
    first, last = np.arange(len(change) - 2 * _NEAR), np.arange(2 * _NEAR, len(change))
    middle = first + _NEAR
    goes_on = (values[middle] - values[first]) * (values[last] - values[middle + 1]) > 0.0
    whole = (breaks[last] == breaks[first]) & goes_on
    least = _NEAR * _STEPS * grid[middle]
    for one, other in ((first, middle), (middle + 1, last)):
        half = path[other] - path[one]
        whole &= (half >= least) & (half > 0.25 * (path[last] - path[first]))
    usual[middle] = np.where(whole, (path[last] - path[first]) / (2 * _NEAR), 0.0)
    return change, usual, grid


def _goes_on_alike(position: Array) -> Mask:
    """Whether each change of a position is the one before, to the last step of its grid."""
    change = np.diff(position)
    step = np.maximum(quantum(position), _last_digit(position)[1:])
    return np.asarray(np.r_[False, np.abs(np.diff(change)) < 0.5 * step[1:]])


def _catches_up(change: Array, usual: Array) -> bool:
    """Whether the first change after repeated values is more than the usual one, as a rule."""
    after = np.flatnonzero((change[:-1] == 0.0) & (usual[:-1] > 0.0) & (change[1:] != 0.0))
    return len(after) > 0 and float(np.median(np.abs(change[after + 1]) / usual[after])) > 1.5


def _grid(values: Array) -> Array:
    """Return the step of the grid around each sample: a number printed to so many digits is coarser where it is large.

    That of a block and of those beside it counts. It is at least the last digit that is printed, and the hundredth part
    of all changes that is smallest, for counts that were printed to few digits and so stand on no grid.
    """
    change = np.abs(np.diff(values))
    least = float(np.quantile(change[change > 0.0], 0.01)) if change.any() else 0.0
    step = np.maximum(_last_digit(values), least)
    steps = np.array([quantum(values[start : start + _BLOCK]) for start in range(0, len(values), _BLOCK)])
    beside = np.maximum(steps, np.maximum(np.r_[steps[1:], 0.0], np.r_[0.0, steps[:-1]]))
    return np.asarray(np.maximum(step, np.repeat(beside, _BLOCK)[: len(values)]))


def _last_digit(values: Array) -> Array:
    """Return what one in the last digit is worth, for numbers of so many significant digits; else eight roundings."""
    size = np.abs(values)
    lead = 10.0 ** np.floor(np.log10(np.where(size > 0.0, size, 1.0)))
    some = slice(None, None, max(len(values) // 4096, 1))
    for digits in range(3, 10):
        scaled = values[some] / lead[some] * 10.0 ** (digits - 1)
        if np.all(np.abs(scaled - np.round(scaled)) < 1e-4):
            return np.asarray(lead * 10.0 ** (1 - digits))
    return np.asarray(8.0 * np.spacing(size))
