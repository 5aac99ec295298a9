"""Positions that jump within one sample and go on from there: an encoder that slipped, a counter that was reset."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.recording import Recording
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.segments import joined

_FURTHER = 5.0
"""A jump is five times as far as any step that is none. Of 300 good recordings, six of them with gaps, stick-slip or
end stops, the furthest steps are up to 2.4 times as far as the next; two encoders that slipped jumped 22 and 28 times
as far as any other step, and 870 and 1200 times as far as their velocity leaves open."""
_MOST = 16
"""Jumps. What is more often is how this drive moves, or is recorded."""
_LEAST = 100
"""Steps of which some can stand out."""
_BESIDE = 4
"""Steps before and after a jump that tell how far the drive went in it."""
_BACK = 0.5
"""Share of a jump that the next step goes back where it is a spike."""
_EXCERPT = 1 << 15


@dataclass(frozen=True)
class Jumps:
    """Where a position jumps.

    Attributes:
        after: the sample before each jump, ascending.
        size: of each, less what the drive went in that step, in the unit of the position; whole steps of its grid.
        beside_velocity: whether a measured velocity does not go along: then it is known that the drive did not.
    """

    after: Index
    size: Array
    beside_velocity: bool


def find_jumps(recording: Recording) -> Jumps | None:
    """Return where the position jumps, or ``None``.

    A step is judged by its length; where a velocity was measured, by the length that this leaves open, and it must be
    further than any other as well, so that lost samples are no jump. A step across a gap in time is none, and one that
    took longer than the usual counts as slower.
    """
    if not recording.measures("position") or len(recording) <= _LEAST:
        return None
    time, position = recording.time, recording["position"]
    length = np.diff(time)
    within = joined(time, recording.run)
    usual = float(np.median(length))
    slower = np.where(within, np.minimum(1.0, usual / np.where(length > 0.0, length, np.inf)), 0.0)
    step = np.diff(position) * slower
    measured = "velocity" in recording and "velocity" not in recording.derived
    open_ = step
    if measured:
        velocity = recording.velocity
        open_ = step - 0.5 * (velocity[1:] + velocity[:-1]) * length * slower
    grid = quantum(position[:_EXCERPT])
    at = _outstanding(np.abs(open_), grid)
    before, after = open_[np.maximum(at - 1, 0)], open_[np.minimum(at + 1, len(open_) - 1)]
    back = np.minimum(before * open_[at], after * open_[at]) < -_BACK * open_[at] ** 2
    at = np.sort(at[~back])
    others = np.abs(step)
    others[at] = 0.0
    at = at[np.abs(step[at]) > (1.0 if measured else _FURTHER) * float(others.max(initial=0.0))]
    if not len(at):
        return None
    going = np.where(within, step, np.nan)
    going[at] = np.nan
    near = at[:, None] + np.r_[-_BESIDE:0, 1 : _BESIDE + 1]
    beside = np.where((near >= 0) & (near < len(going)), going[np.clip(near, 0, len(going) - 1)], np.nan)
    went = np.array([float(np.median(row[np.isfinite(row)])) if np.isfinite(row).any() else 0.0 for row in beside])
    size = np.diff(position)[at] - went / slower[at]
    return Jumps(at.astype(np.int64), grid * np.rint(size / grid) if grid > 0.0 else size, measured)


def _outstanding(size: Array, step: float) -> Index:
    """Return which few sizes are five times as large as all others, and as the step of the grid."""
    if len(size) <= _LEAST:
        return np.zeros(0, dtype=np.int64)
    largest = np.argpartition(size, -_MOST - 1)[-_MOST - 1 :]
    largest = largest[np.argsort(-size[largest])]
    lower = np.maximum(size[largest[1:]], step)
    apart = np.flatnonzero((size[largest[:-1]] > _FURTHER * lower) & (lower > 0.0))
    return largest[: int(apart[-1]) + 1] if len(apart) else largest[:0]


def mend_jumps(recording: Recording) -> Recording:
    """Return the recording with a position that goes on, where a velocity tells that the drive did not jump.

    In each run the longest part between two jumps keeps its place. Its provenance then says ``jumps``, the time from
    the beginning [s] and the size of each.
    """
    found = find_jumps(recording)
    if found is None or not found.beside_velocity:
        return recording
    position = recording["position"].copy()
    for number in np.unique(recording.run[found.after]):
        rows = np.flatnonzero(recording.run == number)
        own = recording.run[found.after] == number
        after, size = found.after[own] - rows[0], np.r_[0.0, np.cumsum(found.size[own])]
        parts = np.diff(np.r_[-1, after, len(rows) - 1])
        position[rows] -= np.repeat(size - size[int(np.argmax(parts))], parts)
    known = [
        [float(recording.time[k] - recording.time[0]), float(s)] for k, s in zip(found.after, found.size, strict=True)
    ]
    return replace(
        recording,
        channels={**recording.channels, "position": position},
        provenance={**recording.provenance, "jumps": known},
    )
