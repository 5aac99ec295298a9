r"""What the terms of a model have everywhere in proportion to the acceleration or to the motor torque.

The first is an inertia. The second is a torque constant that is off: the motor gives :math:`(1 + g)\tau_m`. A recorded
torque that is wrong by e then puts the balance :math:`T_e` wrong by (1 + g) e, so that errors are
:math:`T_e/(1 + g)`, in the torque as it was recorded. Else a model would have a smaller error for nothing but a smaller
g, and another one than its equal with another inertia: :math:`(1 + g)\tau_m = J\dot\omega + \tau_F` and
:math:`\tau_m = (J\dot\omega + \tau_F)/(1 + g)` are one statement.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording


def of_acceleration(drive: Drive, values: Mapping[str, float]) -> float:
    """Return the torque per acceleration that terms of a model have everywhere, as an inertia has [kg m² or kg].

    It belongs to the balance of momentum, where a change of velocity needs no derivative.

    Args:
        drive: model and inertia. values: parameters by key.
    """
    return _slope(drive, values, "acceleration")


def of_motor_torque(drive: Drive, values: Mapping[str, float]) -> float:
    """Return the torque per motor torque that terms of a model have everywhere, −g.

    Args:
        drive: model and inertia. values: parameters by key.
    """
    return _slope(drive, values, "motor_torque")


def applied_torque(drive: Drive, values: Mapping[str, float], recording: Recording) -> Array:
    """Return what motor and load apply, (1 + g) τ_m − τ_L, shape (N,).

    Args:
        drive: model and inertia. values: parameters by key. recording: gives the signals.
    """
    gain = of_motor_torque(drive, values)
    return recording.driving_torque - gain * recording.torque if gain else recording.driving_torque


def in_recorded_torque(drive: Drive, values: Mapping[str, float]) -> float:
    """Return how much recorded motor torque is one unit of torque in the balance, 1/(1 + g); infinite if none is.

    Args:
        drive: model and inertia. values: parameters by key.
    """
    share = 1.0 - of_motor_torque(drive, values)
    return 1.0 / share if share > 0.0 else float("inf")


def recorded_inertia(drive: Drive, values: Mapping[str, float]) -> float:
    """Return the recorded motor torque per acceleration, which turns noise of the motion into noise of the error.

    What a term takes off the drive's inertia, as a spring does that of the link, comes back with its states.

    Args:
        drive: model and inertia. values: parameters by key.
    """
    own = drive.split(values)[0]
    return max(own, own + of_acceleration(drive, values)) * in_recorded_torque(drive, values)


def proportional_torque(drive: Drive, values: Mapping[str, float], recording: Recording) -> Array | None:
    """Return the torque of both kinds together, shape (N,), or nothing where a model has none.

    It needs no part of the care that is taken of friction where a drive turns or rests.

    Args:
        drive: model and inertia. values: parameters by key. recording: gives the signals.
    """
    slopes = {"acceleration": of_acceleration(drive, values), "torque": of_motor_torque(drive, values)}
    parts: list[Array] = [slope * recording[channel] for channel, slope in slopes.items() if slope]
    return sum(parts[1:], parts[0]) if parts else None


def _slope(drive: Drive, values: Mapping[str, float], signal: Literal["acceleration", "motor_torque"]) -> float:
    """Return the torque per unit of a signal that terms of a model have everywhere."""
    if signal not in drive.model.needs:
        return 0.0
    linear = [*drive.model.linear_of(values), 1.0]
    return float(drive.constant_derivatives[int(signal == "motor_torque")] @ linear)
