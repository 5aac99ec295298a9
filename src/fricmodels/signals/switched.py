"""A torque that is switched between a few values, as by a relay: an exact command, and no rounded measurement."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.signals.noise_colour import Noise
from fricmodels.signals.noise_level import noise_of
from fricmodels.signals.segments import Runs

_FEW = 3
"""Values of a torque that is switched: forward, off and backward."""
_EXCERPT = 4096


def is_switched(torque: Array) -> bool:
    """Whether a torque, shape (N,), takes no more than three values."""
    return len(np.unique(torque[:_EXCERPT])) <= _FEW and len(np.unique(torque)) <= _FEW


def torque_noise(time: Array, torque: Array, runs: Runs | None = None) -> Noise:
    """Return the noise of a torque, its lasting part as small as it may be; none of one that is switched.

    Rounding to a grid leaves errors of up to half a step where the values between are passed. A relay passes none.

    Args:
        time: sample times [s], shape (N,).
        torque: at these, shape (N,).
        runs: run of each sample.
    """
    return Noise(0.0) if is_switched(torque) else noise_of(time, torque, runs, least=True)
