"""Whether samples are new ones, and fine enough."""

from __future__ import annotations

import shlex
from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.signals.beginnings import false_beginnings
from fricmodels.signals.clusters import LEVEL
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.switched import is_switched

_NEAR = 8
"""Samples on each side from which the usual change is taken."""
_STEPS = 4.0
"""Steps of the grid by which a channel changes from sample to sample where a repeated value is no rounding."""
_FEW_JUMP = 500
"""Of so many samples one may be a spike, and two in a short log."""
_BLOCK = 512
_COARSE = 0.01
"""Rounding of a hundredth of a channel's RMS is as large as the torque error that is looked for."""


def repeated(log: Log) -> Iterator[Finding]:
    """Judge whether values stand still while the channel changes: polled less often than logged, or lost samples.

    Looked at is where a channel changes by four steps of its grid or more from sample to sample, on the average over
    eight samples on each side, and goes the same way on both. There an exact repetition is one value among many, and
    changes by a step, or a thirtieth of the usual change, either way are more frequent. The two counts are compared by
    the binomial test of one half. A position that was not new catches up in the next step; one that stood still does
    not, and is left out.
    """
    from scipy.special import bdtrc

    for channel, values in log.short.recording.channels.items():
        if channel not in log.measured or channel not in ("position", "velocity", "torque", "acceleration"):
            continue
        if not np.any(values[1:] == values[:-1]):
            continue
        change, usual, grid = _moving(log.short, values)
        total = int(np.count_nonzero(usual))
        if channel == "position" and not _catches_up(change, usual):
            continue
        if not total:
            continue
        same = int(np.count_nonzero(change[usual > 0.0] == 0.0))
        small = int(np.count_nonzero((usual > 0.0) & (np.abs(change) <= np.maximum(1.5 * grid, usual / 30.0)))) - same
        if same <= small or bdtrc(same - 1, same + small, 0.5) >= LEVEL:
            continue
        share = same / total
        often = f", a new one every {1 / max(1 - share, 1 / total):.2g} samples" if share > 0.3 else ""
        yield Finding(
            "repeated-samples",
            Severity.WARN,
            channel,
            f"{100 * share:.2g} % of the samples of the {log.called(channel)} repeat the one before while it changes"
            f"{often}",
            "log each new value once" if share > 0.3 else "drop repeated samples",
        )


def constant(log: Log) -> Iterator[Finding]:
    """Say which channel of the drive has one value throughout though the drive moves: a sensor or a column is dead."""
    for channel, values in log.measured.items():
        if channel not in ("position", "torque", "acceleration") or np.ptp(values) > 0.0:
            continue
        remedy = f"map the column that was measured, as with --column {channel}=COLUMN"
        yield Finding(
            "constant-channel",
            Severity.WARN,
            channel,
            f"the {log.called(channel)} is {log.size(channel, float(values[0]))} throughout, while the drive moves",
            remedy if channel == "torque" else f"{remedy}, or take this one out of the file",
        )


def spikes(log: Log) -> Iterator[Finding]:
    """Say where a channel jumps away for one sample and back at once, further than all else reaches.

    Its distance from both neighbours, to the same side, is more than the range of all samples but the five hundredth
    that jump furthest. No drive does that; a bus that lost a bit does.
    """
    for channel in ("torque", "current", "velocity", "position", "load_torque"):
        values = log.measured.get(channel)
        if values is None or (channel == "current" and "torque" in log.measured) or is_switched(values):
            continue
        change = np.where(log.joined, np.diff(values), 0.0)
        there, back = np.r_[0.0, change], np.r_[change, 0.0]
        jump = np.where(there * back < 0.0, np.minimum(np.abs(there), np.abs(back)), 0.0)
        few = max(2, len(values) // _FEW_JUMP)
        if len(values) <= few or 3.0 * jump.max() <= np.ptp(values):  # with spikes to both sides it is more
            continue
        kept = values[np.argpartition(jump, -few)[:-few]]
        usual = float(np.ptp(kept))
        at = np.flatnonzero(jump > usual)
        if usual == 0.0 or not len(at):
            continue
        unit, time = log.unit(channel), log.recording.time[at[0]] - log.recording.time[0]
        more = f", and so do {len(at) - 1} more" if len(at) > 1 else ""
        yield Finding(
            "spike",
            Severity.WARN,
            channel,
            f"one sample of the {log.called(channel)}, {time:.6g} s from the beginning, jumps to {values[at[0]]:.4g} "
            f"{unit} and back at once, where all others are {kept.min():.4g} to {kept.max():.4g}{more}",
            "remove such rows",
        )


def overlooked(log: Log) -> Iterator[Finding]:
    """Say which columns nothing uses, though they look like a channel that the recording lacks."""
    for channel, column in log.recording.provenance.get("overlooked", {}).items():
        option = shlex.quote(f"{channel}={column}")
        yield Finding(
            "unused-column",
            Severity.WARN,
            channel,
            f"the column '{column}' is not used, and looks like the {channel}",
            f"--column {option} takes it",
        )


def unequal(log: Log) -> Iterator[Finding]:
    """Say which columns of another length are not used, though they look like samples of this recording."""
    size = len(log.recording)
    for column, length in log.recording.provenance.get("other_lengths", {}).items():
        yield Finding(
            "unused-column",
            Severity.WARN,
            column,
            f"the column '{column}' is not used: it has {length} values, where the others have {size}",
            "save all columns with one length",
        )


def unread_units(log: Log) -> Iterator[Finding]:
    """Say which columns are taken for SI though words in brackets at their ends may be a unit that is not known."""
    for channel, words in log.recording.provenance.get("unread_units", {}).items():
        yield Finding(
            "unit",
            Severity.WARN,
            channel,
            f"the {log.called(channel)} is taken for {log.unit(channel)}; '({words})' is not known as a unit",
            f"if it is one give the unit, as in {log.option(channel, 'UNIT')}",
        )


def without_sign(log: Log) -> Iterator[Finding]:
    """Say which channels were written without their sign, and read with it."""
    for channel, register in log.recording.provenance.get("registers", {}).items():
        yield Finding(
            "unsigned",
            Severity.WARN,
            channel,
            f"the {log.called(channel)} was written without its sign, as a register of {register}; it was read with it",
        )


def beginnings(log: Log) -> Iterator[Finding]:
    """Say where the velocity of a first sample is no velocity: a difference begins so."""
    at = false_beginnings(log.recording)
    if len(at):
        velocity, unit = log.recording.velocity, log.unit("velocity")
        more = f", as in {len(at) - 1} further stretches" if len(at) > 1 else ""
        yield Finding(
            "false-beginning",
            Severity.WARN,
            "velocity",
            f"the {log.called('velocity')} begins with {velocity[at[0]]:.4g} {unit} before {velocity[at[0] + 1]:.4g} "
            f"{unit}{more}: a difference begins so; the line through the next two samples is taken instead",
        )


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


def quantisation(log: Log) -> Iterator[Finding]:
    r"""Say which channels stand on a grid, and warn where it is coarse.

    Rounding to steps of q has the standard deviation :math:`q/\sqrt{12}` (Widrow and Kollár 2008). A channel is coarse
    where that is more than a hundredth of its RMS value about its mean, and more than the noise within a step; a
    position, where the speed of a step a sample is never reached.
    """
    for channel in log.measured:
        step = log.resolution[channel]
        values = log.short.recording[channel]
        if step <= 0.0 or channel in ("temperature", "load_torque"):
            continue
        if channel == "torque" and "current" in log.measured:
            continue  # it stands on the grid of the current
        if channel in ("torque", "current") and is_switched(values):
            yield Finding(
                "switched",
                Severity.NOTE,
                channel,
                f"the {log.called(channel)} takes {len(np.unique(values))} values only: it is taken as a command "
                "that is switched, and exact; what drives may lag behind it",
            )
            continue
        spread = float(np.std(values))
        rounding = step / np.sqrt(12.0)
        distinct = float(np.ptp(values)) / step
        if channel == "position":
            change = np.abs(np.diff(values))[log.short.joined]
            coarse = "velocity" not in log.measured and bool(np.quantile(change, 0.99) <= step)
        else:
            coarse = rounding > _COARSE * spread
        if coarse or (channel == "position" and distinct < 2**20):
            yield Finding(
                "quantisation",
                Severity.WARN if coarse else Severity.NOTE,
                channel,
                f"the {log.called(channel)} comes in steps of {log.size(channel, step)}, {distinct:.0f} over its range",
                "log it finer" if coarse else "",
            )
