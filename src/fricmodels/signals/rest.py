r"""Where the drive stands still, told from its motion by statistics.

The velocity is smoothed by local least squares; a sample may be at rest if the smoothed velocity is within three
standard errors of zero. That happens at each reversal too, so the velocity must stay there: longer than any smooth passage through
zero could, :math:`2\cdot 3\,\mathrm{se}/a` with the acceleration a with which this recording otherwise leaves the band.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricmodels.recording import Recording
from fricmodels.signals.lanczos import best_half_width, even_weights, lanczos_derivative, noise
from fricmodels.signals.segments import Array, stretches

_BAND = 3.0
"""Standard errors from zero within which a velocity is no evidence of motion."""


def resting(recording: Recording) -> NDArray[np.bool_]:
    """Return where the drive stands still, shape (N,).

    From the measured velocity; from the position where the velocity is not there or was derived.

    Raises:
        InputError: when the recording has neither.
    """
    velocity, error = smoothed_velocity(recording)
    still = np.abs(velocity) <= _BAND * error
    passage = _passage(recording, velocity, error)
    mask = np.zeros(len(recording), dtype=bool)
    for part in stretches(recording.time, recording.run):
        change = np.flatnonzero(np.diff(still[part].astype(np.int8))) + 1
        borders = np.r_[0, change, part.stop - part.start] + part.start
        for start, stop in zip(borders[:-1], borders[1:], strict=True):
            if still[start] and stop - start > 1:
                mask[start:stop] = recording.time[stop - 1] - recording.time[start] > passage
    return mask


def smoothed_velocity(recording: Recording) -> tuple[Array, float]:
    """Return the velocity, smoothed, and its standard error from noise and quantisation."""
    time, run = recording.time, recording.run
    if "velocity" in recording and not ("velocity" in recording.derived and "position" in recording):
        values, order = recording.velocity, 0
    else:
        values, order = recording["position"], 1
    width = best_half_width(time, values, run)
    smooth = lanczos_derivative(time, values, width, run)[order]
    gain = float(np.linalg.norm(even_weights(width)[order]))
    error = noise(time, values, run) * gain / (recording.interval if order else 1.0)
    rounding = 8.0 * np.spacing(np.abs(values).max()) / (recording.interval if order else 1.0)
    return smooth, max(error, float(rounding))


def _passage(recording: Recording, velocity: Array, error: float) -> float:
    """Return how long [s] a passage through the band about zero lasts, going at the slower of the usual accelerations.

    The usual acceleration is taken where the speed is low but certain; its lower quartile stands for slow passages.
    """
    speed = np.abs(velocity)
    moving = speed > _BAND * error
    if not moving.any():
        return 0.0
    low = moving & (speed <= max(np.quantile(speed[moving], 0.25), 2.0 * _BAND * error))
    acceleration = np.abs(_slope(recording, velocity))[low]
    slow = float(np.quantile(acceleration, 0.25)) if len(acceleration) else 0.0
    shortest = 3.0 * recording.interval
    return max(2.0 * _BAND * error / slow, shortest) if slow > 0.0 else shortest


def _slope(recording: Recording, velocity: Array) -> Array:
    return lanczos_derivative(recording.time, velocity, 5, recording.run)[1]
