"""Samples of which it is not known for certain how the drive moved: about standstill, and where it passes near it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.signals import smoothed_velocity, stretches
from fricmodels.signals.rest import once
from fricmodels.weakform.test_functions import HOPS

Array = NDArray[np.float64]

CERTAIN = 3.0
"""Standard errors from zero at which the direction of motion is certain."""


def direction_unclear(
    drive: Drive,
    recording: Recording,
    smooth: Array,
    resting: NDArray[np.bool_],
    width: int,
    parameters: Mapping[str, float],
) -> NDArray[np.bool_]:
    """Mark the samples whose direction of motion is not certain, and those that their smoothing reaches.

    Args:
        drive: with the model under test.
        recording: prepared.
        smooth: velocity freed of noise.
        resting: samples at rest.
        width: samples that a bump spans.
        parameters: the model's parameters by key.
    """
    error = smoothed_velocity(recording)[1]
    unclear = resting | creeping(recording, width) | hidden_turns(drive, recording, smooth, error, parameters)
    return widened(unclear, 1 + recording.derived_over)


def creeping(recording: Recording, width: int) -> NDArray[np.bool_]:
    """Mark where the drive creeps so slowly that noise hides which way, for longer than an eighth of a bump.

    There the friction torque is not known, nor whether the drive moves at all. A reversal passes through faster.
    """
    known = _creeping(recording)
    if width not in known:
        known[width] = _slow_for_long(recording, max(2, width // HOPS))
    return known[width]


@once
def _creeping(_: Recording) -> dict[int, NDArray[np.bool_]]:
    return {}


def _slow_for_long(recording: Recording, count: int) -> NDArray[np.bool_]:
    """Mark stretches of more than so many samples in which noise hides the direction."""
    velocity, error = smoothed_velocity(recording)
    slow = np.abs(velocity) <= CERTAIN * error
    unclear = np.zeros(len(recording), dtype=bool)
    for part in stretches(recording.time, recording.run):
        borders = np.flatnonzero(np.diff(slow[part].astype(np.int8))) + 1
        edges = np.concatenate([[0], borders, [part.stop - part.start]]) + part.start
        long = slow[edges[:-1]] & (np.diff(edges) > count)
        unclear[part] = np.repeat(long, np.diff(edges))
    return unclear


def hidden_turns(
    drive: Drive, recording: Recording, smooth: Array, error: float, parameters: Mapping[str, float]
) -> NDArray[np.bool_]:
    """Mark passages near zero speed of which the samples do not show the course.

    Where the velocity could have reached zero between two samples, it passed cleanly only if the torque at both drives
    it on in one direction, beyond what friction holds. Otherwise it may have stuck, or turned twice, in between. So it
    may where both velocities are zero as far as can be told.
    """
    from fricmodels.weakform import split

    marked = np.empty(len(recording), dtype=bool)
    least, most = drive.sticking_interval(recording, parameters)
    push = recording.driving_torque
    split.hidden_turns(smooth, recording.run, CERTAIN * error, push, least, most, marked)
    return marked


def widened(mask: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Mark also the ``reach`` samples before and after each marked one."""
    near, done = mask.copy(), 0
    while done < reach and done < len(mask):
        step, before = min(done + 1, reach - done), near.copy()
        near[step:] |= before[:-step]
        near[:-step] |= before[step:]
        done += step
    return near
