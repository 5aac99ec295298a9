"""Maximum likelihood of an asymmetric law whose unrecorded force is coloured: generalised least squares of the torque.

The force that no channel has is a Gaussian process: white, and with parts that die out with time (an offset, and a
level of friction whose sign goes with the motion) or with distance (the same by place, and the wave of 2.5 mm). Sizes
and lengths are found by restricted maximum likelihood, the law's parameters given them by generalised least squares.
Samples near a reversal are left out, the others are filtered at 20 Hz and thinned to 50 Hz.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.signal import butter, filtfilt

from fricmodels import Recording

PARTS = {
    "fast offset": (0.4, 0.05),
    "slow offset": (0.4, 5.0),
    "slow level": (0.4, 5.0),
    "wave over place": (0.6, 0.1),
}
"""Parts of the force, with the size [N] and the time [s] or length [m] that the search begins with."""
KEYS = ("M", "K_v", "K_c", "asymmetry.d", "asymmetry.c")
_WAVE = 2512.0
_THIN, _CUTOFF, _SLOWEST = 20, 20.0, 0.004


@dataclass(frozen=True)
class Coloured:
    """Parameters and their standard errors, the sizes and lengths of the parts, and what the delay was found as [s]."""

    parameters: dict[str, float]
    errors: dict[str, float]
    parts: dict[str, tuple[float, float]]
    delay: float


def fitted(recording: Recording, parts: Sequence[str], *, delay: bool = False) -> Coloured:
    """Return the fit; with ``delay`` the motor's torque may act later than it was recorded, to first order."""
    time, place, velocity, design, right = _rows(recording, delay)
    apart, distance = np.abs(time[:, None] - time), place[:, None] - place
    side = np.sign(velocity)[:, None] * np.sign(velocity)

    def covariance(at: np.ndarray) -> np.ndarray:
        found = np.eye(len(time)) * np.exp(2 * at[0])
        for i, name in enumerate(parts):
            size, length = np.exp(2 * at[1 + 2 * i]), np.exp(at[2 + 2 * i])
            if name == "wave over place":
                found += size * np.cos(_WAVE * distance) * np.exp(-0.5 * (distance / length) ** 2)
            else:
                found += size * np.exp(-apart / length) * (side if name.endswith("level") else 1.0)
        return found

    def solved(at: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        root = np.linalg.cholesky(covariance(at))
        a, z = np.linalg.solve(root, design), np.linalg.solve(root, right)
        normal = a.T @ a
        theta = np.linalg.solve(normal, a.T @ z)
        left = z - a @ theta
        likelihood = -0.5 * left @ left - np.log(np.diag(root)).sum() - 0.5 * np.linalg.slogdet(normal)[1]
        return theta, np.sqrt(np.diag(np.linalg.inv(normal))), float(likelihood)

    at = np.log([0.7, *(value for name in parts for value in PARTS[name])])
    at = minimize(
        lambda x: -solved(x)[2] if np.all(np.abs(x) < 8) else 1e9,
        at,
        method="Powell",
        options={"maxiter": 3, "xtol": 0.05, "ftol": 1e-3},
    ).x
    theta, errors, _ = solved(np.atleast_1d(at))
    found = np.exp(np.atleast_1d(at))
    lag = float(theta[5] / theta[0]) if delay else 0.0
    named = {name: (float(found[1 + 2 * i]), float(found[2 + 2 * i])) for i, name in enumerate(parts)}
    parameters, spread = (dict(zip(KEYS, values[:5].tolist(), strict=True)) for values in (theta, errors))
    return Coloured(parameters, spread, named, lag)


def _rows(recording: Recording, delay: bool) -> tuple[np.ndarray, ...]:
    """Return time, place, velocity, regressors and force of the samples that count."""
    time, step, half = recording.time, recording.interval, 0.5 / recording.interval
    first, second = butter(4, 100 / half), butter(4, _CUTOFF / half)
    place = filtfilt(*first, recording["position"])
    velocity = np.gradient(place, step)
    acceleration = np.gradient(velocity, step)
    sign = np.sign(np.where(np.abs(velocity) < 1e-4, 0.0, velocity))
    columns = [acceleration, velocity, sign, np.abs(velocity), np.abs(sign)]
    if delay:
        columns.append(np.gradient(acceleration, step))
    near = np.convolve(np.abs(velocity) < _SLOWEST, np.ones(51), "same") > 0
    near[:100] = near[-100:] = True
    kept = np.arange(0, len(time), _THIN)
    kept = kept[~near[kept]]
    design = np.column_stack([filtfilt(*second, column) for column in columns])
    return time[kept], place[kept], velocity[kept], design[kept], filtfilt(*second, recording.torque)[kept]
