"""Levenberg–Marquardt within bounds, for a function whose derivatives come from differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Mask

STEP = 1e-4
"""Of a difference, in sizes of a parameter: a stop or a breakaway that moves within a sample is then smoothed over."""
_FIRST_DAMPING, _LARGEST_DAMPING = 1e-3, 1e8
_WEAKER, _STRONGER = 0.2, 4.0
_CONVERGED, _TWICE = 1e-5, 2
"""A fall of the cost by less than this share, so many times in a row, is the last."""


@dataclass(frozen=True)
class Minimum:
    """Where a search ended.

    Attributes:
        at: parameters.
        converged: whether the cost fell no more, or the search was cut off.
    """

    at: Array
    converged: bool


def jacobian(
    residual: Callable[[Array], Array],
    at: Array,
    here: Array,
    step: Array,
    bounds: tuple[Array, Array],
    *,
    central: bool = False,
) -> Array:
    """Return the derivative of a residual by differences, shape (N, n); they point away from a bound, or end at it.

    Args:
        residual: the function. at: where. here: its value there. step: of each parameter. bounds: least and greatest.
        central: to both sides, which long differences need.
    """
    columns = np.zeros((len(here), len(at)))
    for i, length in enumerate(step):
        up, down = min(at[i] + length, bounds[1][i]), max(at[i] - length, bounds[0][i])
        if not central:
            up, down = (up, at[i]) if up - at[i] >= length else (at[i], down)
        if up > down:
            columns[:, i] = (_moved(residual, at, here, i, up) - _moved(residual, at, here, i, down)) / (up - down)
    return columns


def _moved(residual: Callable[[Array], Array], at: Array, here: Array, i: int, to: float) -> Array:
    if to == at[i]:
        return here
    moved = at.copy()
    moved[i] = to
    return residual(moved)


def minimised(
    residual: Callable[[Array], Array],
    start: Array,
    size: Array,
    bounds: tuple[Array, Array],
    *,
    most: int = 60,
    weights: Callable[[Array], Array] | None = None,
    relative_step: float = STEP,
) -> Minimum:
    """Return a local minimum of the sum of squares of a residual.

    Args:
        residual: of shape (N,); not a number where it cannot be had, which is worse than anything.
        start: parameters to begin from. size: of each, for differences. bounds: least and greatest value of each.
        most: Jacobians.
        weights: of each residual, from the residuals, for losses other than squares (iteratively reweighted).
        relative_step: of a difference, in sizes of a parameter.
    """
    low, high = bounds
    at = np.clip(start, low, high)
    here = residual(at)
    if not np.all(np.isfinite(here)):
        return Minimum(at, False)
    damping, stalled = _FIRST_DAMPING, 0
    for _ in range(most):
        step = relative_step * np.maximum(np.abs(at), size)
        slope = jacobian(residual, at, here, step, bounds, central=relative_step > STEP)
        good = np.all(np.isfinite(slope), axis=0)
        slope = np.where(good, slope, 0.0)
        weight = np.ones(len(here)) if weights is None else weights(here)
        cost = float(weight @ here**2)
        gradient, normal = slope.T @ (weight * here), slope.T @ (slope * weight[:, None])
        free = ~(((at <= low) & (gradient > 0)) | ((at >= high) & (gradient < 0))) & (np.diag(normal) > 0)
        fall = 0.0
        while damping < _LARGEST_DAMPING and free.any():
            trial = _trial(at, normal, gradient, free, damping, bounds)
            there = residual(trial)
            reached = float(weight @ there**2) if np.all(np.isfinite(there)) else np.inf
            if reached < cost:
                fall, at, here = 1.0 - reached / cost, trial, there
                damping = max(damping * _WEAKER, 1e-12)
                break
            damping *= _STRONGER
        stalled = stalled + 1 if fall < _CONVERGED else 0
        if fall == 0.0 or stalled >= _TWICE:
            return Minimum(at, True)
    return Minimum(at, False)


def _trial(at: Array, normal: Array, gradient: Array, free: Mask, damping: float, bounds: tuple[Array, Array]) -> Array:
    """Return where a damped step leads; a parameter that it takes to a bound stays there, and the others go on."""
    trial, left = at.copy(), free.copy()
    for _ in range(len(at)):
        which = np.flatnonzero(left)
        if not len(which):
            break
        matrix = normal[np.ix_(which, which)]
        moved = trial - at
        right = gradient[which] + normal[np.ix_(which, np.flatnonzero(~left))] @ moved[~left]
        scale = np.sqrt(np.diag(matrix))
        scaled = matrix / np.outer(scale, scale) + damping * np.eye(len(which))
        step = -np.linalg.lstsq(scaled, right / scale, rcond=None)[0] / scale
        target = at[which] + step
        outside = (target < bounds[0][which]) | (target > bounds[1][which])
        trial[which] = np.clip(target, bounds[0][which], bounds[1][which])
        if not outside.any():
            break
        left[which[outside]] = False
    return trial
