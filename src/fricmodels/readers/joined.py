"""Channels that stand in rows of their own, as merged topics of a robot do, brought to the rows of the motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.signals.segments import gap_lengths

_MOTION = ("position", "velocity")
_MOSTLY = 0.5
"""Share of the rows that lack a value from which on the channels stand in rows of their own."""


def stands_apart(channels: Mapping[str, Array]) -> bool:
    """Whether channels were sampled apart: most rows lack one, and most values of the rarest stand without another.

    Where a channel begins later or ends sooner than the others, its values stand beside theirs.

    Args:
        channels: array of shape (N,) of each channel; no number where a row has no value.
    """
    there = [np.isfinite(values) for name, values in channels.items() if name != "time"]
    fewest, whole = min((int(one.sum()) for one in there), default=0), np.logical_and.reduce(there)
    return bool(fewest and np.mean(~whole) >= _MOSTLY and np.sum(whole) <= (1.0 - _MOSTLY) * fewest)


def joined(channels: Mapping[str, Array], run: Index) -> tuple[dict[str, Array], list[str]]:
    r"""Bring all channels to the rows that have the motion, along straight lines between their own samples.

    .. math:: x(t) = x_k + (x_{k+1} - x_k)\,\frac{t - t_k}{t_{k+1} - t_k}, \qquad t_k \le t < t_{k+1}

    Not across a gap of a channel, see :func:`fricmodels.signals.segments.gap_lengths`, nor before its first or after
    its last sample: no number stands there. A torque that is held between its samples comes half an interval early by
    that, which a fit leaves free.

    Args:
        channels: array of shape (N,) of each channel, samples of each run together.
        run: run number of each row, shape (N,).

    Returns:
        The channels, with numbers in the rows of the motion only; and the names of those that were brought there.
    """
    time = channels["time"]
    motion = [np.isfinite(channels[name]) for name in _MOTION if name in channels]
    if not motion:
        return dict(channels), []
    together = np.logical_and.reduce(motion)
    rows = np.flatnonzero((together if together.any() else motion[0]) & np.isfinite(time))
    found, brought = dict(channels), []
    for name, values in channels.items():
        if name == "time" or np.isfinite(values[rows]).all():
            continue
        found[name], there = np.full(len(time), np.nan), np.isfinite(values) & np.isfinite(time)
        brought.append(name)
        for number in np.unique(run[rows]):
            own, at = np.flatnonzero(there & (run == number)), rows[run[rows] == number]
            if len(own) > 1 and np.all(np.diff(time[own]) > 0.0):
                found[name][at] = _between(time[at], time[own], values[own])
    elsewhere = np.ones(len(time), dtype=bool)
    elsewhere[rows] = False
    others = (name for name in channels if name != "time")
    return {"time": time, **{name: np.where(elsewhere, np.nan, found[name]) for name in others}}, brought


def _between(at: Array, time: Array, values: Array) -> Array:
    """Return values at other times, and no number across a gap or beyond the ends."""
    cell = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    across = (np.diff(time) >= gap_lengths(time))[cell] & (at != time[cell]) & (at != time[cell + 1])
    return np.where(across, np.nan, np.interp(at, time, values, left=np.nan, right=np.nan))
