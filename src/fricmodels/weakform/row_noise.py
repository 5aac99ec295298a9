"""What noise of the velocity leaves in the rows, and how wide test functions must be for it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative, noise
from fricmodels.weakform.test_functions import HOPS, TestFunctions, mean_velocity

Array = NDArray[np.float64]

_NARROWEST, _WIDEST = 16, 128
_DERIVED = 6
"""A bump spans at least so many half widths of the derivation of the velocity, at which friction is evaluated."""
_NOISE_SHARE = 0.01
"""The bump is widened until the noise of the velocity adds less than this share of the RMS torque to a row."""


def noise_like(recording: Recording, deviation: float, rng: np.random.Generator) -> Array:
    """Return noise as the velocity has it: white where it was measured, a derivative of white where it was derived."""
    white = rng.standard_normal(len(recording))
    if not recording.derived_over:
        return deviation * white
    time, position, run, width = recording.time, recording["position"], recording.run, recording.derived_over
    return np.asarray(lanczos_derivative(time, noise(time, position, run) * white, width, run)[1])


def momentum_noise(bumps: TestFunctions, recording: Recording, deviation: float) -> Array:
    """Return the momentum per inertia that noise alone would show, shape (rows,).

    Args:
        bumps: of the recording.
        recording: whose position or velocity is noisy.
        deviation: standard deviation of the noise of a measured velocity.
    """
    white = np.random.default_rng(0).standard_normal(len(recording))
    if not recording.derived_over:
        return bumps.momentum(deviation * white)
    own = noise(recording.time, recording["position"], recording.run)
    return bumps.momentum(mean_velocity(recording, own * white))


def bump_width(recording: Recording, inertia: float, deviation: float) -> int:
    """Return the least width at which velocity noise adds less than the stated share of the RMS torque to a row."""
    torque = float(np.sqrt(np.mean(recording.torque**2)))
    wanted = _NOISE_SHARE * torque * recording.interval
    shortest = int(np.min(np.unique(recording.run, return_counts=True)[1]))
    narrowest = max(_NARROWEST, -(-_DERIVED * recording.derived_over // HOPS) * HOPS)
    widest = max(narrowest, min(_WIDEST, shortest // 40 // HOPS * HOPS))
    moving = np.zeros(len(recording), dtype=bool)
    for width in range(narrowest, widest, HOPS):
        bumps = TestFunctions(recording, width, moving, over_cells=recording.derived_over > 0)
        rows = inertia * momentum_noise(bumps, recording, deviation)
        if not len(rows) or float(np.sqrt(np.mean(rows**2))) <= wanted:
            return width
    return widest
