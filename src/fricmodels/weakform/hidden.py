"""What noise of the velocity hides: the instants at which the drive turns, and regressors near standstill."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import rms
from fricmodels.drive import Drive
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals import smoothed_velocity, velocity_noise


@once
def sign_is_hidden(recording: Recording) -> bool:
    r"""Return whether noise exceeds a tenth of what the velocity changes in a sampling interval (root mean square).

    As much of the noise counts as changes in that time, :math:`\sqrt{r_0 - r_1}`; of white noise all.
    """
    changes = np.diff(recording.velocity)[np.diff(recording.run) == 0]
    usual = rms(changes) if len(changes) else 0.0
    now, later = velocity_noise(recording).covariance(2)
    return bool(now - later > (0.1 * usual) ** 2)


def drowned(drive: Drive, recording: Recording, values: Mapping[str, float]) -> dict[str, float]:
    """Return key → what velocity noise makes of each parameter's regressor, as a share of it.

    The regressor is compared at a smoothed velocity and at one larger by the standard deviation of the noise, where
    the drive surely moves. Standard errors take regressors as known and do not see this.
    """
    smooth, error = smoothed_velocity(recording)
    deviation = velocity_noise(recording).deviation
    moving = np.abs(smooth) > 3.0 * error
    if not moving.any():
        return {}
    there = recording.select(moving)
    here = drive.jacobian(there.with_channels(velocity=smooth[moving]), values)
    moved = smooth[moving] + deviation * np.sign(smooth[moving])
    change = np.linalg.norm(drive.jacobian(there.with_channels(velocity=moved), values) - here, axis=1)
    size = np.linalg.norm(here, axis=1)
    return {
        p.key: float(changed / whole) if whole > 0.0 else 0.0
        for p, changed, whole in zip(drive.model.parameters, change, size, strict=True)
    }


def lost_in_noise(shares: Mapping[str, float]) -> dict[str, str]:
    """Return key → reason for each parameter whose regressor is less than three times what noise makes of it."""
    reason = "what it multiplies is hidden in the noise of the velocity: the drive moves too slowly for it"
    return {key: reason for key, share in shares.items() if share > 1 / 3}
