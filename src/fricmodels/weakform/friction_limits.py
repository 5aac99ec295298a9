"""The most that a fitted friction may hold of what rises with speed, and of what falls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.once import once
from fricmodels.recording import Recording


def limits_of_friction(drive: Drive, recording: Recording, parameters: Mapping[str, float]) -> tuple[float, float]:
    """Return the most that can rise with speed [torque/velocity] and fall [torque] of a model's friction.

    Neither part can be more than all of the friction, in the direction that has more of it. How a model divides its
    friction between them is not known so well, least of all while an effect is missing.
    """
    peak, grid, few = _speeds(recording)
    states = [np.full(len(grid), state.initial) for state in drive.model.states]
    most = float(np.max(np.abs(drive.friction(few, parameters, velocity=grid, states=states))))
    return most / (peak or 1.0), most


@once
def _speeds(recording: Recording) -> tuple[float, Array, Recording]:
    """Return the largest speed, velocities up to it either way, and the first sample so many times."""
    peak = recording.peak_speed
    grid = np.concatenate([[1e-9], np.geomspace(1e-4, 1.0, 40)]) * (peak or 1.0)
    grid = np.concatenate([grid, -grid])
    return peak, grid, recording.select(np.zeros(len(grid), dtype=np.int64))
