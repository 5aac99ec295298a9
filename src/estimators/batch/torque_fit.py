"""Fits the torque equation of a drive: weak form, or derivatives of filtered signals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.batch.inference import covariance
from estimators.batch.problem import linear_constraints, nonlinear_search
from estimators.batch.projection import Equations, Projection, Solution
from estimators.batch.separable import Separable, separable
from estimators.batch.weak_form import HOPS, Bumps, Quadrature, segments
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.recording import Recording

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TorqueFit:
    """A torque-error fit in the order of the drive's parameters, in SI units."""

    values: Array
    covariance: Array
    solution: Solution
    order: NDArray[np.int64]
    width: int


def weak_equations(drive: Drive, quadrature: Quadrature, bumps: Bumps, recording: Recording) -> Equations:
    """Return the equation of motion seen through bumps."""
    split = separable(drive.model)
    driving = (quadrature.recording.torque - quadrature.recording.load_torque)[None]
    momentum = bumps.momentum(recording.velocity)
    target = bumps.integrals(quadrature.integrand(driving))[0]
    if drive.inertia is not None:
        target = target - drive.inertia * momentum

    def moving(alpha: Array) -> Array:
        return bumps.integrals(quadrature.integrand(split.moving_rows(quadrature.recording, alpha)))

    fixed = bumps.integrals(quadrature.integrand(split.fixed_rows(quadrature.recording)))
    return Equations(split, target, momentum if drive.inertia is None else None, fixed, moving)


def fit_equations(
    drive: Drive, recording: Recording, equations: Equations, independent: float, width: int
) -> TorqueFit:
    """Solve, and order parameters and covariance as the drive has them."""
    linear = [p for p in drive.parameters if p.linear]
    constraints, limits = linear_constraints(linear)
    if len(equations.target) <= len(drive.parameters):
        raise EstimationError(
            f"recording '{recording.name}' gives {len(equations.target)} equations for {len(drive.parameters)} "
            "parameters of the drive; it moves too little or is too short"
        )
    solution = Projection(equations, constraints, limits).solve(nonlinear_search(drive, recording))
    order = np.argsort(_places(drive, equations.separable), kind="stable")
    spread = covariance(solution.jacobian.T, solution.residual, solution.normal.inverse, independent)
    values = np.concatenate([solution.theta, solution.alpha])[order]
    return TorqueFit(values, spread[np.ix_(order, order)], solution, order, width)


def _places(drive: Drive, split: Separable) -> NDArray[np.int64]:
    shift = 0 if drive.inertia is not None else 1
    first = [0] * shift
    return np.array([*first, *(shift + i for i in (*split.linear, *split.nonlinear))])


def weak_fit(
    drive: Drive, recording: Recording, width: int | None, resting: NDArray[np.bool_], velocity: Array
) -> TorqueFit:
    """Fit the weak form, the friction evaluated at ``velocity``.

    Without a width, bumps of 16, 32, 64, … samples are tried, up to a quarter of the longest stretch without a gap,
    and those are taken whose estimates have the smallest (generalised) variance.
    """
    quadrature = Quadrature.of(recording, velocity, resting)
    if width is not None:
        return _fit_width(drive, recording, quadrature, width, resting)
    longest = max(piece.stop - piece.start for piece in segments(recording))
    widths = [8 * 2**i for i in range(1, 12) if 8 * 2**i <= max(longest // 4, 16)]
    fits = []
    for candidate in widths:
        try:
            fits.append(_fit_width(drive, recording, quadrature, candidate, resting))
        except EstimationError:
            if candidate == widths[-1] and not fits:
                raise
    return min(fits, key=lambda fit: _generalised_variance(fit.covariance, fit.solution))


def _generalised_variance(covariance: Array, solution: Solution) -> float:
    """Return the logarithm of the determinant over the determined directions; infinite where there are fewer."""
    size = np.sqrt(np.diag(covariance))
    sign, value = np.linalg.slogdet(covariance)
    return float(value) if sign > 0 and np.all(size > 0) and solution.converged else np.inf


def _fit_width(
    drive: Drive, recording: Recording, quadrature: Quadrature, width: int, resting: NDArray[np.bool_]
) -> TorqueFit:
    bumps = Bumps(recording, width, resting)
    equations = weak_equations(drive, quadrature, bumps, recording)
    return fit_equations(drive, recording, equations, 2.0 * bumps.count / HOPS, bumps.width)
