"""Whether a fit explains the torque without the motion that it makes: then nothing was learnt of the drive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import rms
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.recording import Recording

_NOTHING = 1e-6
"""Share of the torque that is rounding. No sensor, and no simulation of one, is as exact."""


def refuse_without_motion(
    drive: Drive, recording: Recording, parameters: Mapping[str, float], residual_percent: float
) -> None:
    r"""Refuse a fit that leaves nothing, and whose inertia needs nothing of the torque.

    Where what is fitted has one torque in each direction, :math:`\tau = \pm K_c` fulfils the equation of motion with
    :math:`J = K_v = 0`, whatever the drive did.

    Args:
        drive: fitted; only an inertia that was estimated can be nothing.
        recording: with ``velocity``.
        parameters: of the drive.
        residual_percent: what the fit leaves, of the RMS torque.

    Raises:
        InputError: where that is so.
    """
    if drive.inertia is not None or not residual_percent < 100.0 * _NOTHING:
        return
    rate = np.diff(recording.velocity) / np.diff(recording.time)
    inertial = parameters[drive.inertia_key] * rms(rate)
    if inertial < _NOTHING * recording.rms_torque:
        raise InputError(
            f"recording '{recording.name}': where it is fitted the torque has one size in each direction, and a "
            "friction of that size explains it without any inertia; give the inertia (--inertia), or record commands "
            "of several sizes"
        )
