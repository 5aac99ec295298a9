r"""By how much an error of a fit grows, because the velocity at which friction is evaluated is predicted by the fit.

An error of the parameters is one of the velocity, and changes what is fitted next. With A the derivative of what the
rows give by the parameters that predicted the velocity, errors at the fixed point are those at a known velocity times
:math:`(1 - A)^{-1}`, and to first order

.. math:: A = (X^TX)^{-1} X^T \frac{\partial r}{\partial v}\,\frac{\partial v}{\partial\theta}

with the residual r of the rows and the velocity v. Within a cell in which the drive turns, stops or starts, a change of
the velocity moves that instant: what it adds to the impulse is the momentum that goes with the change. That is the
derivative. Where friction falls with speed a standard error is no small change: a drive that leaves rest runs away from
where it was. So along the one direction of which most comes back the velocity is predicted anew, and fitted anew.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fricmodels.arrays import Array, deviations
from fricmodels.weakform.solve import Solved

_SEEN = 1e-12
"""Share of the largest eigenvalue of the correlations below which a direction is rounding in any case."""
MOST_FEEDBACK = 0.9
"""Rounds that converge more slowly than by this factor are not told from such that do not."""


def feedback(found: Solved, changes: Array, fitted: Callable[[Array], Array]) -> Array:
    r"""Return :math:`(1 - A)^{-1}`, shape (n, n), of a fit at a velocity that it predicts.

    Args:
        found: the fit.
        changes: derivative of the velocity by each of the drive's parameters, shape (n, N); 0 at rest.
        fitted: what the rows give at the velocity that other parameters predict, shape (n,) → (n,). It is asked twice,
            a standard error to either side along the direction of which most comes back.
    """
    if not changes.any():
        return np.eye(len(changes))
    root, back = _axes(found.covariance, found.solution.normal.rounding)
    response = back @ found.moved_by(_left_by(found, root.T @ changes))
    most = np.linalg.svd(response)[2][0]
    here, step = found.values, root @ most
    by_difference = 0.5 * back @ (fitted(here + step) - fitted(here - step))
    response += np.outer(by_difference - response @ most, most)
    radius = float(np.max(np.abs(np.linalg.eigvals(response)), initial=0.0))
    response *= min(1.0, MOST_FEEDBACK / max(radius, MOST_FEEDBACK))
    unit = np.eye(len(response))
    return np.asarray(np.eye(len(here)) + root @ (np.linalg.inv(unit - response) - unit) @ back)


def _axes(covariance: Array, rounding: float = 0.0) -> tuple[Array, Array]:
    """Return R with RR' the covariance, in units of the standard errors, and its inverse from the left.

    Args:
        covariance: of the parameters, shape (n, n).
        rounding: share of its largest eigenvalue to which it is true. Along what is known better than that by so much
            an axis points anywhere.
    """
    spread = deviations(covariance)
    size = np.where(spread > 0.0, spread, 1.0)
    value, vector = np.linalg.eigh(covariance / np.outer(size, size))
    seen = value > max(_SEEN, rounding) * max(float(value[-1]), 1e-300)
    scale = np.sqrt(value[seen])
    return size[:, None] * vector[:, seen] * scale, vector[:, seen].T / scale[:, None] / size


def _left_by(found: Solved, changes: Array) -> Array:
    """Return what changes of the velocity, shape (n, N), change in what is left of the rows, shape (n, rows)."""
    problem = found.problem
    drive, points, cell = problem.drive, problem.points, problem.quadrature.cell
    count, cells = len(problem.recording), len(problem.quadrature.cell)
    torque, by_velocity, _, _ = drive.linearised(points, found.parameters)
    net = points.driving_torque - torque
    everywhere = np.concatenate([changes, changes[:, cell], changes[:, cell + 1]], axis=1)
    inertia, _ = drive.split(found.parameters)
    moving = inertia * ~problem.resting
    momentum = np.zeros_like(changes)
    momentum[:, cell] = (
        _share(net[count + cells :], net[cell + 1]) * moving[cell + 1] * changes[:, cell + 1]
        - _share(net[count : count + cells], net[cell]) * moving[cell] * changes[:, cell]
    )
    return np.asarray(problem.integrals(-by_velocity * everywhere) + problem.test_functions.of_cells(momentum))


def _share(at_zero: Array, beside: Array) -> Array:
    """Return the torque that accelerates at zero velocity, of that at the sample beside it: 0 to 1."""
    return np.clip(np.divide(at_zero, beside, out=np.zeros_like(beside), where=beside != 0.0), 0.0, 1.0)
