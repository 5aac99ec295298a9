"""Whether a drive goes one way only."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array

_PART = 1.0 / 32.0
"""Share of the time that the drive goes the other way: less than one cluster of the torque balance. And of the way: at
rest noise goes both ways for half of the time each."""


def goes_one_way(velocity: Array) -> bool:
    """Whether the drive hardly ever turns back, by the time or by the way that it goes in each direction.

    A constant torque and Coulomb friction are the same there.

    Args:
        velocity: shape (N,), evenly sampled or nearly so.
    """
    speeds = np.maximum(velocity, 0.0), np.maximum(-velocity, 0.0)
    time = min(float(np.mean(speed > 0.0)) for speed in speeds)
    ways = [float(np.sum(speed)) for speed in speeds]
    return time < _PART or min(ways) < _PART * sum(ways)
