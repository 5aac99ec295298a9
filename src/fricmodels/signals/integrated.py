r"""The position of a recording that has none: the integral of its velocity.

.. math:: q(t) = \int_0^t \omega\,dt

from zero at the first sample of each run, by the trapezium rule. What it lacks is where each run began, and it wanders
with the errors of the velocity: by :math:`\sigma \sqrt{t\,\Delta t}` after a time t if they are white, of standard
deviation σ. A torque over the position shows in it all the same, as long as that is short against its waves.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording


def with_integrated_position(recording: Recording) -> Recording:
    """Return a recording with a position, marked as derived, where only its velocity was measured; else as it is."""
    if recording.measures("position") or not recording.measures("velocity"):
        return recording
    return recording.with_channels(position=from_zero(recording, recording.velocity))


def from_zero(recording: Recording, velocity: Array) -> Array:
    """Return the integral of a velocity along a recording, from zero at the first sample of each run, shape (N,)."""
    position = way(recording.time, velocity)
    for number in recording.run_numbers:
        inside = recording.run == number
        position[inside] -= position[np.argmax(inside)]
    return position


def way(time: Array, velocity: Array) -> Array:
    """Return the integral of a velocity from the first sample on, shape (N,)."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
