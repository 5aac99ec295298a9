"""Times at which a logger lost all of its channels, and wrote the last values again and again.

Taken for samples, these are a drive that stood still under a torque and then jumped. They are left out, and nothing
connects what is on both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.recording import Recording
from fricmodels.signals.clusters import LEVEL

_SHORTEST = 3
"""Repetitions in succession from which on values were lost: one or two may be a device that was slower than its log."""
_JUMP = 3.0
"""Times the usual change from sample to sample by which the motion jumps when the values come back."""
_MOST = 0.5
"""Share of the rows up to which they were lost: of more, that they repeat is how the log was written."""
_OF_THE_WAY = 0.5
"""Share of the way at the speeds before and after that a position jumps by at least when it comes back."""
_ROWS = 4
"""Rows over which these speeds are taken."""


def without_outages(recording: Recording) -> Recording:
    """Return a recording without the rows of outages; how many there were is in ``provenance["outages"]``.

    An outage is a stretch of rows that repeat the one before in all channels, so long that by how often single rows do
    none is to be expected in the recording at :data:`~fricmodels.signals.clusters.LEVEL`, and after which the motion
    jumps. A drive that rests, or runs steadily, loses nothing, and may start with a jump: a position has to make up for
    the way that was lost, further than a recorded velocity goes in that step; a velocity, where no position was
    recorded, has not to be zero. It may stand still wherever the command does; so more rows must be before a jump than
    repeat one another up to a usual change, or to the end.
    """
    names = [name for name in recording.channels if name != "time" and recording.measures(name)]
    motion = next((name for name in ("position", "velocity") if name in names), None)
    if motion is None or "torque" not in names:
        return recording
    first, last = _repeated([recording[name] for name in names], recording.run)
    long = last - first >= _least(first, last, len(recording))
    first, last = first[long], last[long]
    change = np.append(np.where(np.diff(recording.run) == 0, np.abs(np.diff(recording[motion])), 0.0), 0.0)
    if not len(first) or not np.any(change > 0.0):
        return recording
    usual = float(np.median(change[change > 0.0]))
    jumps, calm = change[last] > _JUMP * usual, change[last] <= usual
    if motion == "position":
        jumps &= change[last] > _OF_THE_WAY * (last - first) * _speed_beside(recording, first, last)
        if "velocity" in names:
            jumps &= change[last] > _JUMP * _way_of_velocity(recording, first, last)
    else:
        jumps &= recording[motion][last] != 0.0
        if np.sum((last - first)[jumps]) <= np.sum((last - first)[calm]):
            return recording
    first, last = first[jumps], last[jumps]
    lost = np.zeros(len(recording) + 1, dtype=np.int64)
    np.add.at(lost, first + 1, 1)
    np.add.at(lost, last + 1, -1)
    kept = np.cumsum(lost)[:-1] == 0
    if kept.all() or np.mean(kept) < _MOST:
        return recording
    lasted = recording.time[last] - recording.time[first]
    known = {"times": len(first), "rows": int(np.sum(~kept)), "longest_s": float(lasted.max())}
    found = recording.select(kept)
    return replace(found, provenance={**found.provenance, "outages": known})


def _repeated(channels: Sequence[Array], run: Index) -> tuple[Index, Index]:
    """Return the first and the last row of each stretch of rows that are alike in all channels."""
    same = run[1:] == run[:-1]
    for values in channels:
        same &= values[1:] == values[:-1]
    edges = np.flatnonzero(np.diff(np.r_[0, same.astype(np.int8), 0]))
    return edges[::2], edges[1::2]


def _speed_beside(recording: Recording, first: Index, last: Index) -> Array:
    """Return the size of the mean change of the position from row to row before and after each stretch, (stretches,).

    Within its run. A drive that turned back meanwhile has little way to make up for.
    """
    position = recording["position"]
    borders = np.r_[0, np.flatnonzero(np.diff(recording.run)) + 1, len(position)]
    own = np.searchsorted(borders, first, side="right")
    before, after = np.maximum(first - _ROWS, borders[own - 1]), np.minimum(last + 1 + _ROWS, borders[own] - 1)
    ways = position[first] - position[before], position[after] - position[np.minimum(last + 1, after)]
    return np.asarray(0.5 * np.abs(ways[0] + ways[1]) / _ROWS)


def _way_of_velocity(recording: Recording, first: Index, last: Index) -> Array:
    """Return how far the largest speed before and soon after goes in the step in which values return, (stretches,)."""
    rows = np.minimum(last[:, None] + np.arange(1, _ROWS + 1), len(recording) - 1)
    after = np.where(recording.run[rows] == recording.run[last][:, None], np.abs(recording.velocity[rows]), 0.0)
    speed = np.maximum(np.abs(recording.velocity[first]), after.max(axis=1))
    return np.asarray(speed * (recording.time[rows[:, 0]] - recording.time[last]))


def _least(first: Index, last: Index, rows: int) -> int:
    """Return how many rows in succession repeat by chance in no recording of so many."""
    single = int(np.count_nonzero(last - first == 1))
    chance = min(max(single, 1) / rows, 0.99)
    return max(int(np.ceil(np.log(LEVEL / rows) / np.log(chance))), _SHORTEST)
