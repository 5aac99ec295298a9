r"""By how much the simulated velocity of a drive changes with each of its parameters, without simulating it again.

Along a simulated motion the change :math:`\delta` of the velocity by a parameter p obeys a linear equation,

.. math:: J\,\dot\delta = -\frac{\partial\tau_F}{\partial\omega}\,\delta - \frac{\partial\tau_F}{\partial p}

(with :math:`-\dot\omega` in place of the last term for the inertia). At rest it is zero. Where the drive turns without
resting its instant of turning changes, so that the change is multiplied by the accelerations after and before it; where
the drive leaves rest its acceleration begins at zero, and nothing jumps.

Source: M. A. Aizerman, F. R. Gantmakher, "On the stability of periodic motions", J. Appl. Math. Mech. 22 (1958), for
the jump.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording


def tangents(drive: Drive, values: Mapping[str, float], recording: Recording, simulated: Array) -> Array:
    """Return the derivative of the simulated velocity by each of the drive's parameters, shape (n, N).

    Args:
        drive: a model without internal states.
        values: parameters by key.
        recording: with the torque that drove the simulation.
        simulated: velocity by these parameters, shape (N,). Each run starts at a given velocity.
    """
    from fricmodels.kernels.recursion import tangents_of_motion

    inertia, _ = drive.split(values)
    torque, by_velocity, by_acceleration, by_parameters = drive.linearised(
        recording.with_channels(velocity=simulated), values
    )
    whole = inertia + by_acceleration
    rate = (recording.driving_torque - torque) / inertia
    push = -by_parameters / whole
    if drive.inertia is None:
        push = np.vstack([-rate / whole, push])
    damping = by_velocity / whole
    found = np.empty((len(push), len(recording)))
    for number in recording.run_numbers:
        inside = np.flatnonzero(recording.run == number)
        step = np.diff(recording.time[inside])
        fade = np.exp(-0.5 * step * (damping[inside[:-1]] + damping[inside[1:]]))
        own = np.empty((len(push), len(inside)))
        tangents_of_motion(simulated[inside], step, rate[inside], fade, np.ascontiguousarray(push[:, inside]), own)
        found[:, inside] = own
    return found
