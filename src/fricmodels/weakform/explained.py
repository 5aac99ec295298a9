"""The motor torque that a fitted model explains, where its friction depends on that torque."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive

_LEAST_DELIVERED = 0.05
"""Share of the motor torque that is delivered at the least, whatever a fit on the way says of a gain or a ripple."""
_STRAIGHT = 1e-9
"""Share of the largest torque by which a friction that is a straight line over the torque may differ from one."""
_STEP, _STEPS, _SETTLED = 1e-5, 12, 1e-10
"""Difference for a slope, of the largest torque; most Newton steps; and a step after which none follows, of it, too."""


def explained_torque(unmoved: Array, recorded: Array, friction: Callable[[Array], Array]) -> Array:
    r"""Return the torque τ with :math:`\tau = \tau_L + J\dot\omega + \tau_F(\tau)` at every sample, shape (N,).

    In one step where the friction is a straight line over the torque. Else by Newton's method from the recorded torque,
    near which it lies: a friction that grows with a power of the torque is no straight line.

    Args:
        unmoved: :math:`\tau_L + J\dot\omega`, shape (N,).
        recorded: motor torque, shape (N,).
        friction: motor torque at every sample → friction torque there.
    """
    size = float(np.max(np.abs(recorded), initial=0.0))
    at_zero, at_one = friction(np.zeros_like(recorded)), friction(np.ones_like(recorded))
    slope = at_one - at_zero
    torque = (unmoved + at_zero) / _delivered(slope)
    bent = np.abs(friction(recorded) - (at_zero + slope * recorded)) > _STRAIGHT * size
    if not bent.any():
        return torque
    torque, step = recorded.copy(), _STEP * size
    for _ in range(_STEPS):
        slope = (friction(torque + step) - friction(torque - step)) / (2.0 * step)
        change = (unmoved + friction(torque) - torque) / _delivered(slope)
        torque += np.clip(change, -size, size)
        if float(np.max(np.abs(change))) <= _SETTLED * size:
            break
    return torque


def _delivered(slope: Array) -> Array:
    """Return the share of the motor torque that is not lost again, with what of it goes into friction."""
    return np.maximum(1.0 - slope, _LEAST_DELIVERED)


def torque_by_acceleration(drive: Drive, estimated: Mapping[str, float]) -> float:
    r"""Return the derivative of the explained motor torque by the acceleration [kg m² or kg].

    It is :math:`(J + \partial\tau_F/\partial\dot\omega) / (1 - \partial\tau_F/\partial\tau)`, where these are constant:
    J/(1 + g) where a torque constant is off.
    """
    linear = np.array([*drive.model.linear_of(estimated), 1.0])
    by_acceleration, by_torque = (drive.constant_derivatives @ linear).tolist()
    return float((drive.split(estimated)[0] + by_acceleration) / max(1.0 - by_torque, _LEAST_DELIVERED))
