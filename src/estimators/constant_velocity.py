"""Friction at constant speed against torque (Kubo et al. 1986), and the modified method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field

from fricmodels.arrays import Array, Index, Mask
from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.estimator import Estimator, EstimatorSettings, Solution
from fricmodels.filtering.preparation import (
    dominant_frequency,
    inertia_guess,
    peak_speed,
    scanned_guess,
    smoothed_acceleration,
)
from fricmodels.fit import Status
from fricmodels.recording import Recording
from fricmodels.signals import velocity_noise

_MOVING = 0.05
"""Least speed of a plateau, as a fraction of the peak speed: below, the drive may stick."""
_SINGULAR = 1e-6
_VAGUE = 0.5
_BY_NOISE = 0.1
"""Share of what tells a coefficient from the others that may be noise of the velocity: it is too small by as much."""


class ConstantVelocitySettings(EstimatorSettings):
    """Settings."""

    acceleration_torque: float = Field(
        0.05, gt=0, lt=1, description="largest J·dω/dt of a plateau, as a fraction of the RMS torque"
    )
    least_samples: int = Field(10, ge=2, description="shortest plateau")


@dataclass(frozen=True)
class _Plateaus:
    samples: Recording
    number: Index
    modified: bool


class ConstantVelocity(Estimator):
    """The constant-velocity method: where the speed is constant the motor torque is the friction torque.

    Stretches of at least ten samples whose inertial torque stays below 5 % of the RMS torque are the plateaus. Where a
    recording has too few of them, the *modified* method uses the samples of near-zero acceleration instead, which a
    sine drive has at its speed peaks. The law is fitted to these samples (nonlinear parameters by their scan). An
    inertia that is not given comes from the other samples. Standard errors are by the distance to an unbiased fit,
    :mod:`fricmodels.interval`.
    """

    name = "constant-velocity"
    summary = "friction against speed on plateaus of constant speed (Kubo et al. 1986)"
    Settings = ConstantVelocitySettings

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        """Fit the law to the plateaus; status ``failed``, with the reason, where the recording has too few.

        Raises:
            EstimationError: for a model with internal states.
        """
        if drive.model.states:
            raise EstimationError(f"'{drive.model.name}' has internal states, which constant speed does not show")
        inertia = inertia_guess(drive, recording)
        kept = recording.with_channels(acceleration=smoothed_acceleration(recording))
        linear = drive.model.linear_parameters
        keys = [p.key for p in linear]
        held = [p.key for p in drive.model.parameters if p.key not in keys]
        guess = scanned_guess(drive, kept) if held else {}
        found = self._plateaus(kept, inertia, len(keys))
        count = len(np.unique(found.number))
        method = "samples of near-zero acceleration" if found.modified else "plateaus of constant speed"
        if count <= len(keys):
            reason = f"the recording has {count} {method}; more than {len(keys)} are needed, at different speeds"
            return Solution(status=Status.FAILED, message=reason)
        design, offset = drive.regressors(found.samples, [guess[key] for key in held])
        omega = dominant_frequency(kept)
        rms = kept.rms_torque
        natural = Scales(force=rms, displacement=peak_speed(kept) / omega, time=1 / omega)
        size = np.array([natural.of(p.declared.dimension) for p in linear])
        columns = design * size[:, None] / rms
        right = found.samples.driving_torque - inertia * found.samples["acceleration"] - offset
        theta, errors, smallest = clustered_least_squares(columns, right / rms, found.number)
        if smallest < _SINGULAR:
            reason = f"the {count} {method} do not differ enough in speed and direction to separate {', '.join(keys)}"
            return Solution(status=Status.FAILED, message=reason)
        noise = velocity_noise(kept).deviation * np.random.default_rng(0).standard_normal(len(found.samples))
        noisy = found.samples.with_channels(velocity=found.samples.velocity + noise)
        changed = drive.regressors(noisy, [guess[key] for key in held])[0] * size[:, None] / rms - columns
        blurred = made_by_noise(columns, changed)
        reason = f"the {method} differ in speed by little more than noise makes them: it is off by an unknown part"
        found_values = {**guess, **dict(zip(keys, (theta * size).tolist(), strict=True))}
        values = {p.key: found_values[p.key] for p in drive.model.parameters}
        if drive.inertia is None:
            inertia = _inertia(drive, kept, {**values, drive.inertia_key: inertia})
            keys = [drive.inertia_key, *keys]
        return Solution(
            parameters={drive.inertia_key: inertia, **values},
            estimated=tuple(keys),
            message=f"from {method}" + (f"; held at the best of their scan: {', '.join(held)}" if held else ""),
            no_interval={p.key: reason for p, share in zip(linear, blurred, strict=True) if share > _BY_NOISE},
            not_identified={
                p.key: f"its standard error is over {_VAGUE:g} of the value that would carry the whole RMS torque"
                for p, error in zip(linear, np.sqrt(np.diag(errors)), strict=True)
                if error > _VAGUE
            },
        )

    def _plateaus(self, recording: Recording, inertia: float, parameters: int) -> _Plateaus:
        rms = recording.rms_torque
        steady = np.abs(inertia * recording["acceleration"]) < self.settings.acceleration_torque * rms
        moving = np.abs(recording.velocity) > _MOVING * peak_speed(recording)
        number = _stretches(recording, steady & moving)
        sizes = np.bincount(number[number >= 0], minlength=1)
        long = (number >= 0) & (sizes[np.maximum(number, 0)] >= self.settings.least_samples)
        if len(np.unique(number[long])) > parameters:
            return _Plateaus(recording.select(long), number[long], modified=False)
        used = number >= 0
        return _Plateaus(recording.select(used), number[used], modified=True)


def _stretches(recording: Recording, mask: Mask) -> Index:
    """Number the uninterrupted stretches of one direction in which the mask holds; −1 elsewhere."""
    direction = np.sign(recording.velocity)
    starts = mask.copy()
    starts[1:] &= ~mask[:-1] | (np.diff(recording.run) != 0) | (np.diff(direction) != 0)
    return np.where(mask, np.cumsum(starts) - 1, -1)


def clustered_least_squares(columns: Array, right: Array, cluster: Index) -> tuple[Array, Array, float]:
    """Return the solution of least squares, its covariance with one observation a cluster, and its conditioning.

    The conditioning is the smallest over the largest eigenvalue of the correlation of the regressors.
    """
    size = np.sqrt(np.mean(columns**2, axis=1))
    if not np.all(size > 0):
        return np.zeros(len(columns)), np.full((len(columns),) * 2, np.nan), 0.0
    unit = columns / size[:, None]
    normal = unit @ unit.T
    eigenvalues = np.linalg.eigvalsh(normal)
    smallest = float(max(eigenvalues[0], 0.0) / eigenvalues[-1])
    if smallest < _SINGULAR:
        return np.zeros(len(columns)), np.full((len(columns),) * 2, np.nan), smallest
    theta = np.linalg.solve(normal, unit @ right)
    scores = unit * (right - theta @ unit)
    _, place = np.unique(cluster, return_inverse=True)
    sums = np.stack([np.bincount(place, weights=row) for row in scores])
    clusters, order = sums.shape[1], len(columns)
    inverse = np.linalg.inv(normal)
    covariance = inverse @ sums @ sums.T @ inverse * clusters / max(clusters - order, 1)
    return theta / size, covariance / np.outer(size, size), smallest


def made_by_noise(columns: Array, changed: Array) -> Array:
    r"""Return the share of noise in what tells each column from the others, shape (k,).

    .. math:: \frac{[G^{-1} N G^{-1}]_{ii}}{[G^{-1}]_{ii}}

    with the products G of the columns, and N of what noise changes of them. Least squares takes the coefficient too
    small by that share (W. A. Fuller, "Measurement error models", 1987), and no scatter of the plateaus shows it.

    Args:
        columns, changed: shape (k, N).
    """
    size = np.sqrt(np.mean(columns**2, axis=1))
    unit, noise = columns / size[:, None], changed / size[:, None]
    inverse = np.linalg.pinv(unit @ unit.T, hermitian=True, rcond=1e-12)
    return np.asarray(np.diag(inverse @ (noise @ noise.T) @ inverse) / np.diag(inverse))


def _inertia(drive: Drive, recording: Recording, values: dict[str, float]) -> float:
    """Return the inertia from what friction leaves of the torque where the drive accelerates."""
    moving = np.abs(recording.velocity) > _MOVING * peak_speed(recording)
    used = recording.select(moving)
    remaining = used.driving_torque - drive.friction(used, values)
    acceleration = used["acceleration"]
    return float(acceleration @ remaining) / float(acceleration @ acceleration)
