"""Whether the content of a recording can be used at all."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fricmodels.errors import InputError
from fricmodels.readers.columns import ROW
from fricmodels.readers.joined import stands_apart
from fricmodels.recording import CHANNELS, Recording


def check(recording: Recording, place: Callable[[int], str] = lambda row: f"sample {row + 1}") -> None:
    """Check that values are finite, time goes forward within each run, and something moves.

    Args:
        recording: samples of each run stand together.
        place: names the place of a sample in its file.

    Raises:
        InputError: one line with the cause, the place and the way out.
    """
    source = recording.provenance.get("source", recording.name)
    columns = recording.provenance.get("columns", {})
    bad = {name: places for name, x in recording.channels.items() if len(places := np.flatnonzero(~np.isfinite(x)))}
    if bad:
        channel = min(bad, key=lambda name: int(bad[name][0]))
        row, more = int(bad[channel][0]), len(np.unique(np.concatenate([*bad.values()]))) - 1
        value = "an empty field or NaN" if np.isnan(recording[channel][row]) else "an infinite value"
        others = f", and {more} more" if more else ""
        raise InputError(
            f"{source}: {place(row)}, {channel} ({columns.get(channel, channel)}): {value}{others}; "
            + (
                "the channels stand in rows of their own, as merged topics do: bring them together with --gaps join"
                if stands_apart(recording.channels)
                else "remove or repair those rows, or leave them out with --gaps drop or --gaps split"
            )
        )
    _check_size(recording, source, columns)
    if len(recording) < 2:
        raise InputError(f"{source}: {len(recording) or 'no'} sample{'s' if len(recording) != 1 else ''}; "
                         f"identification needs many")  # fmt: skip
    _check_time(recording, source, place)
    _check_motion(recording, source)


_CLOSER = 0.1
"""Share of the distance to the next row at which the row of the same thing at the next time is, half of the time."""
_TICKS, _TICKING = 3, 0.01
"""Pairs of equal stamps, and their share of all, that are no slips of a logger."""
GREATEST = 1e153
"""Greater numbers, and steps of time below its inverse, have no square: nothing can be computed from them."""


def _check_size(recording: Recording, source: str, columns: Mapping[str, str]) -> None:
    for channel, values in recording.channels.items():
        size = float(np.abs(values).max(initial=0.0))
        if size > GREATEST or (channel in ("torque", "velocity") and 0.0 < size < 1 / GREATEST):
            raise InputError(
                f"{source}: {channel} ({columns.get(channel, channel)}) goes up to {size:.3g}, which no drive does; "
                f"correct its unit or its exponent"
            )
    step = float(np.abs(np.diff(recording.time)).max(initial=0.0))
    if 0.0 < step < 1 / GREATEST:
        raise InputError(f"{source}: the time goes on by {step:.3g} s at most from sample to sample; correct its unit")


def _check_time(recording: Recording, source: str, place: Callable[[int], str]) -> None:
    within = np.diff(recording.run) == 0
    step = np.diff(recording.time)
    back = np.flatnonzero(within & (step <= 0))
    if len(back):
        row = int(back[0]) + 1
        before, here = recording.time[row - 1 : row + 1]
        cause = f"the time {here:.9g} s is repeated" if here == before else (
            f"the time goes back from {before:.9g} s to {here:.9g} s"
        )  # fmt: skip
        if several := interleaved(recording):
            raise InputError(
                f"{source}: {place(row)}: {cause}: at each time there are rows of {several} things, as of {several} "
                f"joints; write the rows of one of them to a file of its own"
            )
        interval = ticking(recording)
        if interval:
            raise InputError(
                f"{source}: {place(row)}: {cause} with other values, as are {len(back) - 1} more: the clock is coarser "
                f"than the samples; count the rows at their mean interval with --column time={ROW}:{interval:.4g}ms"
            )
        run = "begin a run there with --gaps split, or name its column with --column run=COLUMN"
        repeated = f"drop repeated samples with --gaps drop, or if a new run begins there {run}"
        raise InputError(
            f"{source}: {place(row)}: {cause}; {repeated if here == before else f'{run}, or put the rows in order'}"
        )
    counts = np.bincount(np.unique(recording.run, return_inverse=True)[1])
    if (counts < 2).any():
        number = recording.run_numbers[int(np.argmin(counts))]
        row = int(np.flatnonzero(recording.run == number)[0])
        raise InputError(f"{source}: {place(row)}: the run {number} has one sample only; remove it")


def interleaved(recording: Recording) -> int:
    """Return of how many things, as joints, there is a row at each time in turn; 0 where rows are not so.

    Then all times have as many rows, and in some channel a row is far closer to that of the same thing at the next time
    than to the next row.
    """
    times, count = np.unique(recording.time, return_counts=True)
    number = int(count[0])
    if number < 2 or len(times) < 3 or np.any(count != number) or np.any(np.diff(recording.time) < 0.0):
        return 0
    rows = [values.reshape(-1, number) for name, values in recording.channels.items() if name != "time"]
    apart = ((np.abs(np.diff(each, axis=1)), np.abs(np.diff(each, axis=0))) for each in rows)
    return number if any(np.median(own) < _CLOSER * np.median(others) for others, own in apart) else 0


def ticking(recording: Recording) -> float | None:
    """Return the mean interval [ms] of samples that have the stamps of a clock coarser than they are, or ``None``.

    Such a clock never goes back, and stamps samples alike that are not: a sample that was written twice has the same
    values. A few pairs of stamps may be slips. The first and the last tick of a run may have begun before it or end
    after it: what counts is from one tick's first sample to another's.
    """
    within = np.diff(recording.run) == 0
    step = np.diff(recording.time)[within]
    alike = np.count_nonzero(step == 0.0)
    if (step < 0.0).any() or alike < max(_TICKS, _TICKING * len(step)):
        return None
    others = [values for channel, values in recording.channels.items() if channel != "time"]
    same = np.logical_and.reduce([np.diff(values)[within] == 0.0 for values in others])
    if np.count_nonzero(same[step == 0.0]) > 0.5 * alike:
        return None
    ticks = np.flatnonzero(within & (np.diff(recording.time) > 0.0)) + 1
    time, samples = 0.0, 0
    for number in np.unique(recording.run[ticks]):
        own = ticks[recording.run[ticks] == number]
        time, samples = time + float(recording.time[own[-1]] - recording.time[own[0]]), samples + int(own[-1] - own[0])
    return 1e3 * time / samples if samples else None


def _check_motion(recording: Recording, source: str) -> None:
    if "velocity" in recording:
        velocity = recording.velocity
    else:
        within = np.diff(recording.run) == 0
        position = recording["position"]
        velocity = (np.diff(position) / np.diff(recording.time))[within]
        rounding = 8 * np.spacing(np.abs(position).max()) / np.diff(recording.time)[within].min()
        if np.ptp(velocity) <= rounding:
            velocity = np.full(1, np.median(velocity) if abs(np.median(velocity)) > rounding else 0.0)
    if np.ptp(velocity) == 0.0:
        if "velocity" in recording and "position" in recording and np.ptp(recording["position"]) > 0.0:
            raise InputError(
                f"{source}: the velocity is {velocity[0]:.6g} throughout, but the position moves by "
                f"{np.ptp(recording['position']):.4g} {CHANNELS['position'].unit(recording.motion)}; take the column "
                f"of the velocity out of the file: it is then derived from the position"
            )
        what = "nothing moves" if velocity[0] == 0.0 else f"the velocity is {velocity[0]:.6g} throughout"
        raise InputError(f"{source}: {what}; friction shows only where the velocity varies")
