"""What the batch estimator asks of a drive and a recording, in the order of the drive's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.batch.projection import Nonlinear
from fricmodels.dimension import Dimension
from fricmodels.drive import Drive, DriveParameter
from fricmodels.recording import Recording

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Outcome:
    """What a fit found, in the order of the drive's parameters, in SI units.

    Attributes:
        values, covariance: the estimates.
        undetermined: directions, in columns of unit length, that change nothing; shape (n, any number).
        succeeded, message: how it ended.
    """

    values: Array
    covariance: Array
    undetermined: Array
    succeeded: bool
    message: str


def natural_size(recording: Recording, dimension: Dimension) -> float:
    """Return the recording's own size of a quantity: peak velocity, position range, duration, RMS torque."""
    peak = float(np.max(np.abs(recording.velocity)))
    duration = float(np.ptp(recording.time))
    force = float(np.sqrt(np.mean(recording.torque**2)))
    length = float(np.ptp(recording["position"])) if "position" in recording else peak * duration
    size = force ** float(dimension.force)
    if dimension.displacement == -dimension.time:
        return float(size * peak ** float(dimension.displacement))
    return float(size * length ** float(dimension.displacement) * duration ** float(dimension.time))


def linear_constraints(parameters: Sequence[DriveParameter]) -> tuple[Array, Array]:
    """Return G and h with ``G θ ≥ h``: bounds of the linear parameters, and which is at least which other."""
    keys = [p.key for p in parameters]
    rows, limits = [], []
    for i, p in enumerate(parameters):
        row = np.zeros(len(keys))
        row[i] = 1.0
        bounded_by_another = p.at_least in keys
        if np.isfinite(p.declared.lower) and not bounded_by_another:
            rows.append(row)
            limits.append(p.declared.lower)
        if np.isfinite(p.declared.upper):
            rows.append(-row)
            limits.append(-p.declared.upper)
        if bounded_by_another:
            row = row.copy()
            row[keys.index(str(p.at_least))] = -1.0
            rows.append(row)
            limits.append(0.0)
    return np.array(rows).reshape(-1, len(keys)), np.array(limits)


def nonlinear_search(drive: Drive, recording: Recording) -> Nonlinear:
    """Return where to look for the nonlinear parameters: their scans in the recording's own sizes."""
    chosen = [p for p in drive.parameters if not p.linear]
    starts = [
        tuple(value * natural_size(recording, p.dimension) for value in p.declared.scan) or (p.declared.initial,)
        for p in chosen
    ]
    return Nonlinear(
        starts,
        np.array([p.declared.lower for p in chosen], dtype=float),
        np.array([p.declared.upper for p in chosen], dtype=float),
        np.array([p.declared.lower >= 0.0 and min(s) > 0.0 for p, s in zip(chosen, starts, strict=True)], dtype=bool),
    )
