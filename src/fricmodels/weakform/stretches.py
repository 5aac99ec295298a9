"""Stretches of a recording without a gap."""

from __future__ import annotations

import itertools

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.segments import gap_lengths


def segments(recording: Recording) -> list[slice]:
    """Return the stretches without a gap, which are those over which signals are smoothed."""
    return stretches_of(recording)[0]


@once
def stretches_of(recording: Recording) -> tuple[list[slice], Array, Mask]:
    """Return the stretches, the duration of each cell, 0 between them, and which cells lie within one."""
    step = np.diff(recording.time)
    broken = (np.diff(recording.run) != 0) | (step >= gap_lengths(recording.time, recording.run))
    edges = [0, *(np.flatnonzero(broken) + 1), len(recording)]
    found = [slice(start, stop) for start, stop in itertools.pairwise(edges)]
    joined = np.zeros(len(step), dtype=bool)
    for piece in found:
        joined[piece.start : piece.stop - 1] = True
    return found, np.where(joined, step, 0.0), joined
