"""Whether samples are new ones, and fine enough."""

from __future__ import annotations

import shlex
from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.errors import InputError
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.readers.header_units import stated_unit
from fricmodels.results.words import figures
from fricmodels.signals.beginnings import false_beginnings
from fricmodels.signals.coasting import coasts
from fricmodels.signals.counted import step_of_counts
from fricmodels.signals.jumps import find_jumps
from fricmodels.signals.switched import is_switched

_UNLIKE = 3.0
"""Times the usual misfit of velocity and position from which a sample is none."""
_FEW_JUMP = 500
"""Of so many samples one may be a spike, and two in a short log."""
_MANY_JUMP, _FARTHER = 20, 3.0
"""And of so many samples, if they all jump so many times the range of all others."""
_TOLD = 3
"""Jumps that are told one by one."""
_COARSE = 0.01
"""Rounding of a hundredth of a channel's RMS is as large as the torque error that is looked for."""


def constant(log: Log) -> Iterator[Finding]:
    """Say which channel of the drive has one value throughout though the drive moves: a sensor or a column is dead."""
    for channel, values in log.measured.items():
        if channel not in ("position", "torque", "acceleration") or np.ptp(values) > 0.0:
            continue
        if channel == "torque" and coasts(log.recording):
            yield Finding(
                "coasting",
                Severity.NOTE,
                channel,
                f"the {log.called(channel)} is 0 throughout while the drive slows down: it coasts. Friction is known "
                "per inertia, which has to be given (--inertia), and errors are in percent of the inertia's RMS torque",
            )
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
    that jump furthest; or three times that of all but the twentieth that do. No drive does that; a bus that lost a bit
    does.
    """
    for channel in ("torque", "current", "velocity", "position", "load_torque"):
        values = log.measured.get(channel)
        if values is None or (channel == "current" and "torque" in log.measured) or is_switched(values):
            continue
        inner = 1 + np.flatnonzero(log.joined[:-1] & log.joined[1:])  # the first of a run may jump unseen
        there, back = values[inner] - values[inner - 1], values[inner + 1] - values[inner]
        values = values[inner]
        jump = np.where(there * back < 0.0, np.minimum(np.abs(there), np.abs(back)), 0.0)
        few = max(2, len(values) // _FEW_JUMP)
        if len(values) <= few or 3.0 * jump.max() <= np.ptp(values):  # with spikes to both sides it is more
            continue
        found = _jumping(values, jump, few, 1.0), _jumping(values, jump, len(values) // _MANY_JUMP, _FARTHER)
        kept, at = max(found, key=lambda one: len(one[1]))
        if not len(at):
            continue
        unit, time = log.unit(channel), log.recording.time[inner[at[0]]] - log.recording.time[0]
        more = f", and so do {len(at) - 1} more" if len(at) > 1 else ""
        yield Finding(
            "spike",
            Severity.WARN,
            channel,
            f"one sample of the {log.called(channel)}, {figures(time, 6)} s from the beginning, jumps to "
            f"{figures(values[at[0]], 4)} "
            f"{unit} and back at once, where all others are {figures(kept.min(), 4)} to {figures(kept.max(), 4)}{more}",
            "remove such rows",
        )


def _jumping(values: Array, jump: Array, most: int, farther: float) -> tuple[Array, Index]:
    """Return the samples but those that jump furthest, and which of all jump farther than so many times their range."""
    kept = values[np.argpartition(jump, -most)[:-most]] if most else values
    usual = float(np.ptp(kept))
    return kept, np.flatnonzero(jump > farther * usual) if usual > 0.0 else np.empty(0, dtype=np.int64)


def unlike_the_position(log: Log) -> Iterator[Finding]:
    """Say where the velocity jumps away for one sample and back at once, and the position does not move like that.

    There the velocity differs from the slope of the position, and on both sides it does not: by more than three times
    as much as in any sample but the few (one of five hundred) that differ most.
    """
    velocity, position = log.measured.get("velocity"), log.measured.get("position")
    if velocity is None or position is None or len(velocity) < 2 * _FEW_JUMP:
        return
    time = log.recording.time
    there, back = np.diff(velocity)[:-1], np.diff(velocity)[1:]
    slope = (position[2:] - position[:-2]) / (time[2:] - time[:-2])
    size = np.where(log.joined[:-1] & log.joined[1:], np.abs(velocity[1:-1] - slope), 0.0)
    few = len(size) // _FEW_JUMP
    usual = float(np.max(np.partition(size, -few)[:-few]))
    far = size > _UNLIKE * usual
    alone = far & ~np.r_[False, far[:-1]] & ~np.r_[far[1:], False]
    at = 1 + np.flatnonzero(alone & (there * back < 0.0) & (np.minimum(np.abs(there), np.abs(back)) > 0.5 * size))
    if usual == 0.0 or not len(at):
        return
    channel = log.called("velocity")
    jumps = f"{len(at)} samples of the {channel} jump" if len(at) > 1 else f"one sample of the {channel} jumps"
    first = ", the first" if len(at) > 1 else ""
    yield Finding(
        "spike",
        Severity.WARN,
        "velocity",
        f"{jumps} away and back at once{first} {figures(time[at[0]] - time[0], 6)} s from the beginning, by up to "
        f"{log.size('velocity', float(size[at - 1].max()))}, and the position does not move like that",
        "leave such values empty and read with --gaps drop, or leave the velocity out",
    )


def jumps(log: Log) -> Iterator[Finding]:
    """Say where the position jumps within one sample and goes on from there; see `signals.jumps`."""
    known = log.recording.provenance.get("jumps", [])
    mended = bool(known)
    if not mended:
        found = find_jumps(log.recording)
        if found is None:
            return
        times = log.recording.time[found.after] - log.recording.time[0]
        known = np.stack([times, found.size], axis=1).tolist()
    told = ", ".join(f"by {log.size('position', size)} after {figures(time, 6)} s" for time, size in known[:_TOLD])
    more = f", and {len(known) - _TOLD} times more" if len(known) > _TOLD else ""
    does = (
        "the velocity does not go along, so that it was put together there"
        if mended
        else "before and after it has other zeros"
    )
    yield Finding(
        "position-jump",
        Severity.WARN,
        "position",
        f"the {log.called('position')} jumps within one sample, {told}{more}, and goes on from there, as where an "
        f"encoder slips, a counter is reset, or samples are missing that the stamps do not show; {does}",
        "" if mended else "cut the log there, or name a column that tells the parts apart with --column run=COLUMN",
    )


def overlooked(log: Log) -> Iterator[Finding]:
    """Say which columns nothing uses, though they look like a channel that the recording lacks."""
    for channel, column in log.recording.provenance.get("overlooked", {}).items():
        option = shlex.quote(f"{channel}={column}{'' if _states_its_unit(column, channel) else ':UNIT'}")
        yield Finding(
            "unused-column",
            Severity.WARN,
            channel,
            f"the column '{column}' is not used, and looks like the {channel}",
            f"--column {option} takes it",
        )


def _states_its_unit(column: str, channel: str) -> bool:
    """Whether the name of a column states no unit, or one that measures the channel."""
    try:
        stated_unit(column, channel)
    except InputError:
        return False
    return True


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
    """Say which columns are taken for SI though their names may state another unit, or one of something else."""
    for channel, why in log.recording.provenance.get("unread_units", {}).items():
        yield Finding(
            "unit",
            Severity.WARN,
            channel,
            f"the {log.called(channel)} is taken for {log.unit(channel)}; {why}",
            f"if it is in another unit give it, as in {log.option(channel, 'UNIT')}",
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


def wrapped_clock(log: Log) -> Iterator[Finding]:
    """Say that the clock began anew where its counter was full, and goes on."""
    period = log.recording.provenance.get("clock_period")
    if period:
        yield Finding(
            "wrapped-clock",
            Severity.NOTE,
            "time",
            f"the time began anew at {period:.12g} in the unit of its column, where its counter is full: it goes on",
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
            f"the {log.called('velocity')} begins with {figures(velocity[at[0]], 4)} {unit} before "
            f"{figures(velocity[at[0] + 1], 4)} "
            f"{unit}{more}: a difference begins so; the line through the next two samples is taken instead",
        )


def quantisation(log: Log) -> Iterator[Finding]:
    r"""Say which channels stand on a grid, and warn where it is coarse.

    Rounding to steps of q has the standard deviation :math:`q/\sqrt{12}` (Widrow and Kollár 2008). A channel is coarse
    where that is more than a hundredth of its RMS value about its mean, and more than the noise within a step; a
    position, where the speed of a step a sample is never reached. A velocity that is a difference of counts is as fine
    as their sum.
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
        if channel == "velocity" and (count := step_of_counts(log.recording)):
            angle = count * log.recording.interval
            yield Finding(
                "counted-velocity",
                Severity.NOTE,
                channel,
                f"the {log.called(channel)} is a difference of counts, each of {figures(angle, 4)} {log.length_unit}: "
                "their sum is taken as the position, from zero on",
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
