"""A torque that is switched between a few values, as by a relay: an exact command, and no rounded measurement."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.noise_colour import Noise
from fricmodels.signals.noise_level import noise_of, quantum
from fricmodels.signals.unlike_files import with_own_noises

_FEW = 3
"""Values of a torque that is switched: forward, off and backward."""
_HELD = 10
"""Samples that half of the values of a staircase last at least, all together: what is only passed lasts one or two."""
_ALONE = 0.5
"""Share of the values of a staircase that have no neighbour on their grid, at least. What is rounded passes from level
to level, and one that stands still between two levels shows both: nearly all of its levels have one."""
_NEARLY = 0.99
"""Share of the samples that have one value where a torque counts as constant: one late row is none of another size."""
_EXCERPT, _MOST = 4096, 256
"""Samples that are looked at first, and values in them from which a torque is no staircase."""


def is_switched(torque: Array) -> bool:
    """Whether a torque, shape (N,), takes no more than three values, or stays on a few with none between them.

    A command in steps of 2.2, 1.4, 0 and -1.2 N m has values that are multiples of 0.2 N m, as if rounded to that. But
    it goes from one to the other without those between, and none stands beside another on that grid.
    """
    if len(np.unique(torque[:_EXCERPT])) > _MOST:
        return False
    values, counts = np.unique(torque, return_counts=True)
    if len(values) <= _FEW:
        return True
    if len(values) > _MOST or np.median(counts) < _HELD:
        return False
    step = quantum(values)
    near = np.diff(values) < 1.5 * step
    return step > 0.0 and float(np.mean(np.r_[near, False] | np.r_[False, near])) <= 1.0 - _ALONE


def one_value_in_each(torque: Array, group: Array | Index | Mask) -> bool:
    """Whether a torque has one value in each group of samples, but for one sample in a hundred.

    Args:
        torque: shape (N,).
        group: number of the group that each sample lies in, as of its run or direction, shape (N,).
    """
    return all(
        np.unique(torque[group == one], return_counts=True)[1].max() >= _NEARLY * np.count_nonzero(group == one)
        for one in np.unique(group)
    )


@once
def torque_noise(recording: Recording) -> Noise:
    """Return the noise of a torque, its lasting part as small as it may be; none of one that is switched.

    Rounding to a grid leaves errors of up to half a step where the values between are passed. A switch passes none.
    What was cut from a recording has the noise of that: blocks of a few strokes tell it badly.

    Args:
        recording: of one or several runs.
    """
    origin = recording.origin
    if origin is not None and np.array_equal(origin.whole.torque[origin.index], recording.torque):
        return torque_noise(origin.whole).at(origin.index)
    return with_own_noises(recording, _noise_of(recording), _noise_of)


def _noise_of(recording: Recording) -> Noise:
    torque = recording.torque
    return Noise(0.0) if is_switched(torque) else noise_of(recording.time, torque, recording.run, least=True)
