"""Friction at constant speed against torque (Kubo et al. 1986), and the modified method."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from estimators.preparation import (
    dominant_frequency,
    inertia_guess,
    peak_speed,
    scanned_guess,
    smoothed_acceleration,
    usable,
)
from estimators.result import failed_fit, provenance
from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.estimator import Estimator, EstimatorSettings
from fricmodels.fit import Fit, Status
from fricmodels.recording import Recording

Array = NDArray[np.float64]

_MOVING = 0.05
"""Least speed of a plateau, as a fraction of the peak speed: below, the drive may stick."""
_SINGULAR = 1e-6
_VAGUE = 0.5


class ConstantVelocitySettings(EstimatorSettings):
    """Settings."""

    acceleration_torque: float = Field(
        0.05, gt=0, lt=1, description="largest J·dω/dt of a plateau, as a fraction of the RMS torque"
    )
    least_samples: int = Field(10, ge=2, description="shortest plateau")


@dataclass(frozen=True)
class _Plateaus:
    samples: Recording
    number: NDArray[np.int64]
    modified: bool


class ConstantVelocity(Estimator):
    """The constant-velocity method: where the speed is constant the motor torque is the friction torque.

    Stretches of at least ten samples whose inertial torque stays below 5 % of the RMS torque are the plateaus. Where a
    recording has too few of them, the *modified* method uses the samples of near-zero acceleration instead, which a
    sine drive has at its speed peaks. The law is fitted to these samples (nonlinear parameters by their scan); the
    standard errors treat each plateau as one observation. An inertia that is not given comes from the other samples.
    """

    name = "constant-velocity"
    summary = "friction against speed on plateaus of constant speed (Kubo et al. 1986)"
    Settings = ConstantVelocitySettings

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Fit the law to the plateaus; status ``failed``, with the reason, where the recording has too few.

        Raises:
            EstimationError: for a model with internal states.
        """
        began = time.perf_counter()
        if drive.model.states:
            raise EstimationError(f"'{drive.model.name}' has internal states, which constant speed does not show")
        kept = usable(drive, recording)
        inertia = inertia_guess(drive, kept)
        acceleration = smoothed_acceleration(kept)
        kept = kept.with_channels(acceleration=acceleration)
        linear = np.array(drive.model.linear)
        keys = [p.key for p, is_linear in zip(drive.model.parameters, linear, strict=True) if is_linear]
        nonlinear: list[float] = []
        if not linear.all():
            guess = scanned_guess(drive, kept).values
            nonlinear = [
                guess[p.key] for p, is_linear in zip(drive.model.parameters, linear, strict=True) if not is_linear
            ]
        found = self._plateaus(kept, inertia, len(keys))
        count = len(np.unique(found.number))
        method = "samples of near-zero acceleration" if found.modified else "plateaus of constant speed"
        if count <= len(keys):
            reason = f"the recording has {count} {method}; more than {len(keys)} are needed, at different speeds"
            return failed_fit(self, drive, kept, began, Status.FAILED, reason)
        design, offset = drive.regressors(found.samples, nonlinear)
        omega = dominant_frequency(kept)
        rms = float(np.sqrt(np.mean(kept.torque**2)))
        natural = Scales(force=rms, displacement=peak_speed(kept) / omega, time=1 / omega)
        size = np.array(
            [natural.of(p.declared.dimension) for p, ok in zip(drive.model.parameters, linear, strict=True) if ok]
        )
        columns = design * size[:, None] / rms
        right = found.samples.torque - found.samples.load_torque - inertia * found.samples["acceleration"] - offset
        theta, errors, smallest = clustered_least_squares(columns, right / rms, found.number)
        if smallest < _SINGULAR:
            reason = f"the {count} {method} do not differ enough in speed and direction to separate {', '.join(keys)}"
            return failed_fit(self, drive, kept, began, Status.FAILED, reason)
        values = dict(zip(keys, (theta * size).tolist(), strict=True))
        held = {
            p.key: value
            for p, value in zip(
                (p for p, ok in zip(drive.model.parameters, linear, strict=True) if not ok), nonlinear, strict=True
            )
        }
        covariance = errors * np.outer(size, size)
        return self._fit(drive, kept, inertia, values | held, keys, covariance, size, method, began)

    def _fit(
        self,
        drive: Drive,
        recording: Recording,
        inertia: float,
        values: dict[str, float],
        keys: list[str],
        covariance: Array,
        size: Array,
        method: str,
        began: float,
    ) -> Fit:
        estimated = tuple(keys)
        vague = {
            key: f"its standard error is over {_VAGUE:g} of the value that would carry the whole RMS torque"
            for key, error, whole in zip(keys, np.sqrt(np.diag(covariance)), size, strict=True)
            if error > _VAGUE * whole
        }
        if drive.inertia is None:
            inertia, variance = _inertia(drive, recording, {**values, drive.inertia_key: inertia})
            wider = np.zeros((len(keys) + 1,) * 2)
            wider[0, 0], wider[1:, 1:] = variance, covariance
            covariance, estimated = wider, (drive.inertia_key, *keys)
        ordered = {p.key: values[p.key] for p in drive.model.parameters}
        held = [key for key in ordered if key not in keys]
        return Fit(
            model=drive.model.name,
            estimator=self.name,
            dataset=recording.name,
            parameters={drive.inertia_key: inertia, **ordered},
            covariance=covariance,
            estimated=estimated,
            message=f"from {method}" + (f"; held at the best of their scan: {', '.join(held)}" if held else ""),
            not_identified=vague,
            seconds=time.perf_counter() - began,
            provenance=provenance(self, recording),
        )

    def _plateaus(self, recording: Recording, inertia: float, parameters: int) -> _Plateaus:
        rms = float(np.sqrt(np.mean(recording.torque**2)))
        steady = np.abs(inertia * recording["acceleration"]) < self.settings.acceleration_torque * rms
        moving = np.abs(recording.velocity) > _MOVING * peak_speed(recording)
        number = _stretches(recording, steady & moving)
        sizes = np.bincount(number[number >= 0], minlength=1)
        long = (number >= 0) & (sizes[np.maximum(number, 0)] >= self.settings.least_samples)
        if len(np.unique(number[long])) > parameters:
            return _Plateaus(recording.select(long), number[long], modified=False)
        used = number >= 0
        return _Plateaus(recording.select(used), number[used], modified=True)


def _stretches(recording: Recording, mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Number the uninterrupted stretches of one direction in which the mask holds; −1 elsewhere."""
    direction = np.sign(recording.velocity)
    starts = mask.copy()
    starts[1:] &= ~mask[:-1] | (np.diff(recording.run) != 0) | (np.diff(direction) != 0)
    return np.where(mask, np.cumsum(starts) - 1, -1)


def clustered_least_squares(columns: Array, right: Array, cluster: NDArray[np.int64]) -> tuple[Array, Array, float]:
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


def _inertia(drive: Drive, recording: Recording, values: dict[str, float]) -> tuple[float, float]:
    """Return the inertia and its variance from what friction leaves of the torque where the drive accelerates."""
    moving = np.abs(recording.velocity) > _MOVING * peak_speed(recording)
    used = recording.select(moving)
    remaining = used.torque - used.load_torque - drive.friction(used, values)
    acceleration = used["acceleration"]
    power = float(acceleration @ acceleration)
    inertia = float(acceleration @ remaining) / power
    scores = np.add.reduceat(
        acceleration * (remaining - inertia * acceleration), np.arange(0, len(used), max(1, len(used) // 20))
    )
    return inertia, float(scores @ scores) / power**2
