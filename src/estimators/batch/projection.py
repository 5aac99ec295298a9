"""Variable projection: linear parameters are eliminated, Gauss–Newton runs on the few others (Kaufman's Jacobian)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimators.batch.least_squares import NormalEquations
from estimators.batch.separable import Separable

Array = NDArray[np.float64]

MAX_STARTS = 64
"""Most combinations of starting values that are tried."""
TOLERANCE = 1e-6
"""A fall of the squared error by less than this share is the end: parameters move by less than a thousandth of the
standard error, √(TOLERANCE)."""


@dataclass(frozen=True)
class Equations:
    """Linear functionals of the equation of motion (bumps, or filtered samples), one an equation.

    Attributes:
        separable: the split model.
        driving: the functionals of τ_m − τ_L, shape (M,).
        target: the functionals of τ_m − τ_L (less J dω/dt where the inertia is given), shape (M,).
        acceleration: the functionals of dω/dt where the inertia is estimated, shape (M,), else ``None``.
        fixed: the functionals of the model's fixed rows, shape (rows, M).
        moving: α, whether with slopes → functionals of the moving rows (and slopes), shape (rows, M).
    """

    separable: Separable
    driving: Array
    target: Array
    acceleration: Array | None
    fixed: Array
    moving: Callable[[Array, bool], Array]


@dataclass(frozen=True)
class Nonlinear:
    """How the nonlinear parameters are searched: starting values, bounds, and which on a logarithmic scale."""

    starts: Sequence[tuple[float, ...]]
    lower: Array
    upper: Array
    logarithmic: NDArray[np.bool_]

    def clip(self, alpha: Array) -> Array:
        """Return the nearest values within the bounds."""
        return np.clip(alpha, self.lower, self.upper)

    def combinations(self) -> list[Array]:
        """Return the starting points: all combinations while they are few, else one parameter varied at a time."""
        total = np.prod([len(values) for values in self.starts])
        if total <= MAX_STARTS:
            return [np.array(values) for values in itertools.product(*self.starts)]
        middle = [values[len(values) // 2] for values in self.starts]
        points = [np.array(middle)]
        for i, values in enumerate(self.starts):
            points += [np.array([*middle[:i], value, *middle[i + 1 :]]) for value in values]
        return points


@dataclass(frozen=True)
class Solution:
    """A least-squares fit: parameters (inertia if estimated, linear θ, nonlinear α), Jacobian and residual."""

    theta: Array
    alpha: Array
    jacobian: Array
    residual: Array
    normal: NormalEquations
    iterations: int
    converged: bool

    @property
    def cost(self) -> float:
        """Sum of squared residuals."""
        return float(self.residual @ self.residual)


class Projection:
    """Solves :class:`Equations` subject to linear constraints on the linear parameters."""

    def __init__(self, equations: Equations, constraints: Array, limits: Array) -> None:
        self._equations = equations
        self._constraints, self._limits = constraints, limits
        split = equations.separable
        self._first = 0 if equations.acceleration is None else 1
        self._width = self._first + len(split.linear)
        count = len(equations.target)
        self._columns = np.zeros((self._width, count))
        if equations.acceleration is not None:
            self._columns[0] = equations.acceleration
        self._target = equations.target.copy()
        for row, values in zip(split.fixed, equations.fixed, strict=True):
            if row == len(split.linear):
                self._target -= values
            else:
                self._columns[self._first + row] = values

    def solve(self, nonlinear: Nonlinear, start: Array | None = None, max_iterations: int = 50) -> Solution:
        """Search from ``start``, or from every starting point roughly and from the best one to the end."""
        if not self._equations.separable.nonlinear:
            return self._at(np.zeros(0))
        points = nonlinear.combinations() if start is None else [start]
        starts = [nonlinear.clip(point) for point in points]
        if len(starts) > 1:
            starts = [min(starts, key=self._cost)]
        return self._descend(self._at(starts[0]), nonlinear, max_iterations)

    def _descend(self, at: Solution, nonlinear: Nonlinear, max_iterations: int) -> Solution:
        damping = 1e-3
        for iteration in range(1, max_iterations + 1):
            scale = np.where(nonlinear.logarithmic, np.maximum(at.alpha, 1e-300), 1.0)
            step = self._step(at, scale, damping)
            log_step = np.clip(np.where(nonlinear.logarithmic, step, 0.0), -1.5, 1.5)
            moved = np.where(nonlinear.logarithmic, at.alpha * np.exp(log_step), at.alpha + step)
            trial = self._at(nonlinear.clip(moved))
            gain = at.cost - trial.cost
            small = float(np.max(np.abs(trial.alpha - at.alpha) / np.maximum(np.abs(at.alpha), 1e-300)))
            if gain >= 0.0:
                damping = max(damping / 10.0, 1e-12)
                better, at = at, trial
                if small < 1e-4 or gain <= TOLERANCE * better.cost:
                    return replace(at, iterations=iteration)
            else:
                damping *= 10.0
                if small < 1e-6 or damping > 1e8:
                    return replace(at, iterations=iteration)
        return replace(at, iterations=max_iterations, converged=False)

    def _step(self, at: Solution, scale: Array, damping: float) -> Array:
        """Return the Levenberg step of α, the linear parameters following (their columns are projected out)."""
        n = self._width
        gram = at.normal.gram * np.outer(at.normal.size, at.normal.size)
        inner = NormalEquations.of(gram[:n, :n], np.zeros(n)).inverse
        cross = gram[:n, n:] * scale
        slopes = at.jacobian[n:] * scale[:, None]
        reduced = gram[n:, n:] * np.outer(scale, scale) - cross.T @ inner @ cross
        gradient = slopes @ at.residual - cross.T @ (inner @ (at.jacobian[:n] @ at.residual))
        diagonal = np.maximum(np.diag(reduced), 1e-300)
        return np.asarray(np.linalg.lstsq(reduced + damping * np.diag(diagonal), gradient, rcond=1e-14)[0])

    def _cost(self, alpha: Array) -> float:
        columns, target, _ = self._linear_problem(alpha, slopes=False)
        residual = target - self._solve(columns, target) @ columns
        return float(residual @ residual)

    def _solve(self, columns: Array, target: Array) -> Array:
        return NormalEquations.of(columns @ columns.T, columns @ target).solve(self._constraints, self._limits)

    def _linear_problem(self, alpha: Array, *, slopes: bool) -> tuple[Array, Array, Array]:
        """Return the columns of the linear parameters, the target and the functionals of the slopes."""
        split = self._equations.separable
        columns, target = self._columns.copy(), self._target
        if not split.moving:
            return columns, target, np.zeros((0, len(target)))
        rows = self._equations.moving(alpha, slopes)
        for row, values in zip(split.moving, rows, strict=False):
            if row == len(split.linear):
                target = target - values
            else:
                columns[self._first + row] = values
        return columns, target, rows[len(split.moving) :]

    def _at(self, alpha: Array) -> Solution:
        split, n = self._equations.separable, self._width
        linear, target, slopes = self._linear_problem(alpha, slopes=True)
        theta = self._solve(linear, target)
        columns = np.concatenate([linear, np.zeros((len(alpha), len(target)))])
        for (row, j), values in zip(split.slopes, slopes, strict=True):
            factor = 1.0 if row == len(split.linear) else theta[self._first + row]
            columns[n + j] += factor * values
        residual = target - theta @ linear
        normal = NormalEquations.of(columns @ columns.T, columns @ residual)
        return Solution(theta, alpha, columns, residual, normal, 0, True)
