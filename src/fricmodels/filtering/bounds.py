"""Keeps the parameters of a filter within their physical bounds."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import Scales
from fricmodels.drive import Drive

_TINY = 1e-300


def bounded(x: Any, covariance: Any, lower: Any, upper: Any, drive: Drive) -> Any:
    """Return the state with its parameters moved to where their physical bounds allow.

    A stick torque below its slip torque, and a nonlinear parameter outside its bounds, are moved along the covariance,
    so that the other estimates follow as if the bound had been observed (Simon and Chia 2002); merely cutting them
    off would drive correlated parameters away together. What is then still outside is cut off.
    """
    import casadi

    moving = x.numel() - len(drive.keys)
    for i, j in _ordered(drive):
        along = covariance[:, moving + i] - covariance[:, moving + j]
        gap = casadi.fmax(x[moving + j] - x[moving + i], 0)
        x = x + along * (gap / casadi.fmax(along[moving + i] - along[moving + j], _TINY))
    for i in _nonlinear(drive):
        along, value = covariance[:, moving + i], x[moving + i]
        gap = casadi.fmin(casadi.fmax(value, lower[i]), upper[i]) - value
        x = x + along * (gap / casadi.fmax(along[moving + i], _TINY))
    parameters = casadi.fmin(casadi.fmax(x[moving:], lower), upper)
    for i, j in _ordered(drive):
        parameters[i] = casadi.fmax(parameters[i], parameters[j])
    return casadi.vertcat(x[:moving], parameters)


def projected(x: Array, covariance: Array, lower: Array, upper: Array, drive: Drive) -> Array:
    """Return what :func:`bounded` builds, for numbers."""
    moving = len(x) - len(drive.keys)
    for i, j in _ordered(drive):
        along = covariance[:, moving + i] - covariance[:, moving + j]
        gap = max(x[moving + j] - x[moving + i], 0.0)
        x = x + along * (gap / max(along[moving + i] - along[moving + j], _TINY))
    for i in _nonlinear(drive):
        along, value = covariance[:, moving + i], x[moving + i]
        x = x + along * ((np.clip(value, lower[i], upper[i]) - value) / max(along[moving + i], _TINY))
    parameters = np.clip(x[moving:], lower, upper)
    for i, j in _ordered(drive):
        parameters[i] = max(parameters[i], parameters[j])
    return np.concatenate([x[:moving], parameters])


def _ordered(drive: Drive) -> list[tuple[int, int]]:
    """Return pairs of parameters of which the first must not fall below the second."""
    return [
        (i, drive.keys.index(parameter.at_least))
        for i, parameter in enumerate(drive.parameters)
        if parameter.at_least is not None
    ]


def _nonlinear(drive: Drive) -> list[int]:
    """Return the parameters that do not enter the torque linearly."""
    return [i for i, parameter in enumerate(drive.parameters) if not parameter.linear]


def normalised_bounds(drive: Drive, scales: Scales) -> tuple[Array, Array]:
    """Return the lower and upper physical bounds of the estimated parameters; an inertia stays above a tenth of 1."""
    size = drive.parameter_scales(scales)
    lower = np.array([p.declared.lower for p in drive.parameters]) / size
    upper = np.array([p.declared.upper for p in drive.parameters]) / size
    if drive.inertia is None:
        lower[0] = 0.1
    return np.maximum(lower, -1e300), np.minimum(upper, 1e300)
