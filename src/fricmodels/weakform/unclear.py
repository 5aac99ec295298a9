"""Samples of which it is not known for certain how the drive moved: about standstill, and where it passes near it."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Mask, widened
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals import smoothed_velocity, stretches
from fricmodels.weakform.test_functions import HOPS

CERTAIN = 3.0
"""Standard errors from zero at which the direction of motion is certain."""


def direction_unclear(recording: Recording, smooth: Array, slow: Mask, limits: tuple[Array, Array]) -> Mask:
    """Mark the samples whose direction of motion is not certain, and those that their smoothing reaches.

    Args:
        recording: prepared.
        smooth: velocity freed of noise.
        slow: samples at rest, and those at which the drive creeps, see :func:`creeping`.
        limits: least and greatest friction torque that holds the drive at rest, shape (N,) each.
    """
    unclear = slow | hidden_turns(recording, smooth, smoothed_velocity(recording)[1], limits)
    return widened(unclear, 1 + recording.derived_over)


@once
def creeping(recording: Recording, width: int) -> Mask:
    """Mark where the drive creeps so slowly that noise hides which way, for longer than an eighth of a test function.

    There the friction torque is not known, nor whether the drive moves at all. A reversal passes through faster.
    """
    velocity, error = smoothed_velocity(recording)
    slow = np.abs(velocity) <= CERTAIN * error
    unclear = np.zeros(len(recording), dtype=bool)
    for part in stretches(recording.time, recording.run):
        borders = np.flatnonzero(np.diff(slow[part].astype(np.int8))) + 1
        edges = np.concatenate([[0], borders, [part.stop - part.start]]) + part.start
        long = slow[edges[:-1]] & (np.diff(edges) > max(2, width // HOPS))
        unclear[part] = np.repeat(long, np.diff(edges))
    return unclear


def hidden_turns(recording: Recording, smooth: Array, error: float, limits: tuple[Array, Array]) -> Mask:
    """Mark passages near zero speed of which the samples do not show the course.

    Where the velocity could have reached zero between two samples, it passed cleanly only if the torque at both drives
    it on in one direction, beyond what friction holds. Otherwise it may have stuck, or turned twice, in between. So it
    may where both velocities are zero as far as can be told.
    """
    from fricmodels.weakform import cell_loops

    marked = np.empty(len(recording), dtype=bool)
    least, most = limits
    push = recording.driving_torque
    cell_loops.hidden_turns(smooth, recording.run, CERTAIN * error, push, least, most, marked)
    return marked
