"""Stretches of a recording without a gap, and strokes of its motion."""

from __future__ import annotations

import itertools

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.recording import Recording
from fricmodels.signals.rest import once

_NO_WAY = 0.1
"""Share of the RMS speed below which a velocity is in no direction: there noise may turn it."""


def segments(recording: Recording) -> list[slice]:
    """Return the stretches without a gap: within a run, no step longer than three median ones."""
    return stretches_of(recording)[0]


@once
def stretches_of(recording: Recording) -> tuple[list[slice], Array, Mask]:
    """Return the stretches, the duration of each cell, 0 between them, and which cells lie within one."""
    step = np.diff(recording.time)
    broken = (np.diff(recording.run) != 0) | (step > 3.0 * recording.interval)
    edges = [0, *(np.flatnonzero(broken) + 1), len(recording)]
    found = [slice(start, stop) for start, stop in itertools.pairwise(edges)]
    joined = np.zeros(len(step), dtype=bool)
    for piece in found:
        joined[piece.start : piece.stop - 1] = True
    return found, np.where(joined, step, 0.0), joined


def strokes(velocity: Array, run: Index) -> int:
    """Return how often a drive went one way, from one reversal to the next or to the end of a run.

    Args:
        velocity: freed of noise, shape (N,).
        run: number of the run of every sample, shape (N,).
    """
    speed = float(np.sqrt(np.mean(velocity**2)))
    moving = np.flatnonzero(np.abs(velocity) > _NO_WAY * speed)
    begun = (np.diff(np.sign(velocity[moving])) != 0) | (np.diff(run[moving]) != 0)
    return 1 + int(np.sum(begun)) if len(moving) else 0
