"""Variable projection: linear parameters are eliminated, Gauss–Newton runs on the few others (Kaufman's Jacobian)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.weakform.errors_in_variables import noise_of_first, without_noise
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.nonlinear import LARGEST_RATIO, Nonlinear
from fricmodels.weakform.separable import Separable

TOLERANCE = 1e-6
"""A fall of the squared error by less than this share is the end: parameters move by less than a thousandth of the
standard error, √(TOLERANCE)."""
_FEW = 2
"""Columns that move, up to which only their own products are made anew."""
_NOTHING = 1e-9
"""Share of the target below which what a parameter changes is rounding, as where its amplitude is at a bound."""
THINNED = 4
"""Of so many equations one is kept of what a starting point leaves, for neighbours say nearly the same."""
_EQUAL = 1e-9
"""Share by which squared errors that are equal but for rounding may differ: the first of them is taken."""
_MOST_STEPS = 50
"""Steps of Gauss–Newton."""


class _Tried:
    """The columns of the linear parameters at the α that was tried last, and their products.

    A search moves one parameter at a time: what does not depend on it stays. Each product is one sum over the rows, so
    that it is the same whatever was tried before.

    Attributes:
        columns: shape (width, M). gram, right: their products with each other and with the target.
        blocks: of each term that moves.
    """

    def __init__(self, columns: Array, gram: Array, target: Array) -> None:
        self.columns, self.gram = columns.copy(), gram.copy()
        self.target, self.right = target, columns @ target
        self.blocks: list[Array | None] = []

    def update(self, places: Sequence[Sequence[int]], blocks: Sequence[Array], target: Array) -> None:
        """Put in other blocks.

        Args:
            places: column of each row of a block, −1 for one that belongs to the target.
            blocks: of each term that moves.
            target: of these blocks.
        """
        before = self.blocks or [None] * len(blocks)
        self.blocks = list(blocks)
        new = []
        for rows, block, known in zip(places, blocks, before, strict=True):
            if block is not known:
                for place, values in zip(rows, block, strict=False):
                    if place >= 0:
                        self.columns[place] = values
                        new.append(place)
        for place in new:
            own = self.columns[place]
            self.gram[place] = self.gram[:, place] = [own @ other for other in self.columns]
        if target is not self.target:
            self.target, new = target, list(range(len(self.columns)))
        for place in new:
            self.right[place] = self.columns[place] @ target


@dataclass(frozen=True)
class Equations:
    """Linear functionals of the equation of motion (test functions, or filtered samples), one an equation.

    Attributes:
        separable: the split model.
        driving: the functionals of τ_m − τ_L, shape (M,).
        target: the functionals of τ_m − τ_L (less J dω/dt where the inertia is given), shape (M,).
        acceleration: the functionals of dω/dt where the inertia is estimated, shape (M,), else ``None``.
        fixed: the functionals of the model's fixed rows, shape (rows, M).
        moving: α, whether with slopes → functionals of the moving rows (and slopes) of each term that has such, shape
            (rows, M). Those of a term that were asked for before may be the same array: it is not to be written to.
        nuisances: columns beside the model, such as a shift in time, shape (m, M).
        nuisance_limits: lower and upper bound of the coefficient of each nuisance, shape (m, 2).
        acceleration_noise: sum of squares that noise adds to the functionals of dω/dt.
    """

    separable: Separable
    driving: Array
    target: Array
    acceleration: Array | None
    fixed: Array
    moving: Callable[[Array, bool], Sequence[Array]]
    nuisances: Array = field(default_factory=lambda: np.zeros((0, 0)))
    nuisance_limits: Array = field(default_factory=lambda: np.zeros((0, 2)))
    acceleration_noise: float = 0.0


@dataclass(frozen=True)
class Scan:
    """What starting points leave of the equations.

    Attributes:
        points: the nonlinear parameters.
        costs: squared error of all equations, shape (points,).
        left: what is left of every :data:`THINNED`-th equation, shape (points, equations).
    """

    points: Sequence[Array]
    costs: Array
    left: Array

    @property
    def best(self) -> Array:
        """The point that leaves least."""
        return self.points[ranked(self.costs)[0]]


@dataclass(frozen=True)
class Solution:
    """A least-squares fit.

    Attributes:
        theta: inertia if it is estimated, linear parameters, coefficients of the nuisances.
        alpha: nonlinear parameters.
        jacobian: columns of theta and alpha, shape (n, M).
        residual: shape (M,).
        normal: normal equations of the Jacobian at the solution.
        iterations, converged: of the Gauss–Newton iteration.
        start: nonlinear parameters that it began from, where it did.
        scan: what the points left among which that is the best one, where there were several.
        settled: whether another step promises nothing: the same iteration, begun from here, would end here.
    """

    theta: Array
    alpha: Array
    jacobian: Array
    residual: Array
    normal: NormalEquations
    iterations: int
    converged: bool
    start: Array | None = None
    scan: Scan | None = None
    settled: bool = False

    @property
    def cost(self) -> float:
        """Sum of squared residuals."""
        return float(self.residual @ self.residual)

    def part(self, chosen: Index) -> NormalEquations:
        """Return the normal equations of some columns of the Jacobian."""
        columns = self.jacobian[chosen]
        return NormalEquations.of(columns @ columns.T, columns @ self.residual)


class Projection:
    """Solves :class:`Equations` subject to linear constraints on the linear parameters.

    Args:
        equations: what is to be solved.
        constraints, limits: ``constraints @ θ ≥ limits``, with the inertia first where it is estimated.
        held: values of linear parameters that are held, by index into θ.
    """

    def __init__(
        self, equations: Equations, constraints: Array, limits: Array, held: Mapping[int, float] | None = None
    ) -> None:
        self._equations = equations
        self._held = dict(held or {})
        split = equations.separable
        self._first = 0 if equations.acceleration is None else 1
        self._nuisances = self._first + len(split.linear)
        self._width = self._nuisances + len(equations.nuisances)
        self._free = np.array([i for i in range(self._width) if i not in self._held], dtype=np.int64)
        self._theta = np.zeros(self._width)
        self._theta[list(self._held)] = list(self._held.values())
        constraints, limits = _with_bounds(constraints, limits, equations.nuisance_limits)
        self._constraints, self._limits = constraints[:, self._free], limits - constraints @ self._theta
        count = len(equations.target)
        self._columns = np.zeros((self._width, count))
        if equations.acceleration is not None:
            self._columns[0] = equations.acceleration
        self._columns[self._nuisances :] = equations.nuisances.reshape(-1, count)
        self._target = equations.target.copy()
        for row, values in zip(split.fixed, equations.fixed, strict=True):
            if row == len(split.linear):
                self._target -= values
            else:
                self._columns[self._first + row] = values
        self._places = [
            [-1 if row == len(split.linear) else self._first + row for row in term.moving]
            for term in split.moving_terms
        ]
        self._moving = sorted({place for places in self._places for place in places if place >= 0})

    def solve(self, nonlinear: Nonlinear) -> Solution:
        """Return the least-squares fit: from the best of the starting points, by Gauss–Newton to the end."""
        if not self._equations.separable.nonlinear:
            return replace(self.at(np.zeros(0)), settled=True)
        starts = nonlinear.points()
        scan = self._scan(starts) if len(starts) > 1 else None
        start = starts[0] if scan is None else scan.best
        return replace(self.descend(self.at(start), nonlinear), start=start, scan=scan)

    def best_start(self, nonlinear: Nonlinear) -> Array:
        """Return the starting point that leaves least."""
        starts = nonlinear.points()
        return self._scan(starts).best if len(starts) > 1 else starts[0]

    def _scan(self, starts: Sequence[Array]) -> Scan:
        costs, left = np.empty(len(starts)), np.empty((len(starts), len(self._target[::THINNED])))
        for i, start in enumerate(starts):
            residual = self._left_at(start)
            costs[i], left[i] = _square(residual), residual[::THINNED]
        return Scan(starts, costs, left)

    def descend(self, at: Solution, nonlinear: Nonlinear) -> Solution:
        """Return the least squares next to a point, by Gauss–Newton to the end."""
        damping, reach = 1e-3, nonlinear.reach
        for iteration in range(1, _MOST_STEPS + 1):
            scale = np.where(nonlinear.logarithmic, np.maximum(at.alpha, 1e-300), 1.0)
            step, promised = self._step(at, scale, damping, ~nonlinear.held)
            if promised <= TOLERANCE * at.cost:
                return replace(at, iterations=iteration, settled=True)
            step = np.clip(step, -reach, reach)
            moved = np.where(nonlinear.logarithmic, at.alpha * np.exp(np.minimum(step, LARGEST_RATIO)), at.alpha + step)
            trial = self.at(nonlinear.clip(moved))
            gain = at.cost - trial.cost
            size = np.minimum(np.maximum(np.abs(at.alpha), 1e-300), np.where(nonlinear.logarithmic, np.inf, reach))
            small = float(np.max(np.abs(trial.alpha - at.alpha) / size))
            if gain >= 0.0:
                damping = max(damping / 10.0, 1e-12)
                better, at = at, trial
                if small < 1e-4 or gain <= TOLERANCE * better.cost:
                    return replace(at, iterations=iteration)
            else:
                damping *= 10.0
                if small < 1e-6 or damping > 1e8:
                    return replace(at, iterations=iteration)
        return replace(at, iterations=_MOST_STEPS, converged=False)

    def _step(self, at: Solution, scale: Array, damping: float, moving: Mask) -> tuple[Array, float]:
        """Return the Levenberg step of α, the linear parameters following (projected out), and the fall it promises."""
        from fricmodels.kernels.small import reduced

        free, last = self._free, self._width + np.flatnonzero(moving)
        gram, scale = at.normal.gram, scale[moving]
        inner = NormalEquations.of(np.ascontiguousarray(gram[free[:, None], free]), np.zeros(len(free))).inverse
        matrix, gradient = np.empty((len(last), len(last))), np.empty(len(last))
        reduced(gram, at.normal.right, inner, free, last, scale, damping, matrix, gradient)
        step = np.zeros(len(moving))
        # Directions that hardly change the residual count too: left out as rounding, they would never be found.
        alone = len(last) == 1
        step[moving] = gradient / matrix[0] if alone else np.linalg.lstsq(matrix, gradient, rcond=1e-14)[0]
        return step, float(gradient @ step[moving])

    def cost(self, alpha: Array) -> float:
        """Return the squared error at α; infinite where the model is not finite there."""
        return _square(self._left_at(alpha))

    def _left_at(self, alpha: Array) -> Array:
        """Return what is left of the equations at α, with the best linear parameters."""
        target = self._moved(self._scanned, self._blocks(alpha, slopes=False))
        with np.errstate(invalid="ignore", over="ignore"):
            theta = self._solve(self._products(self._scanned), self._scanned @ target, target)[0]
            return np.asarray(target - theta @ self._scanned)

    def cost_beside(self, alpha: Array) -> float:
        """Return :meth:`cost`, but for rounding, in less time where α is that of the last one but for a parameter."""
        tried, blocks = self._tried, self._blocks(alpha, slopes=False)
        with np.errstate(invalid="ignore", over="ignore"):
            tried.update(self._places, blocks, self._target_beside(blocks))
            return _square(tried.target - self._solve(tried.gram, tried.right, tried.target)[0] @ tried.columns)

    @cached_property
    def _scanned(self) -> Array:
        """The columns of the linear parameters at the α that was scanned last, shape (width, M)."""
        return self._columns.copy()

    @cached_property
    def _tried(self) -> _Tried:
        return _Tried(self._columns, self._fixed_products, self._target)

    def _blocks(self, alpha: Array, *, slopes: bool) -> Sequence[Array]:
        return self._equations.moving(alpha, slopes) if self._places else ()

    def _moved(self, columns: Array, blocks: Sequence[Array]) -> Array:
        """Write the columns of the linear parameters that depend on α; return the target."""
        for places, block in zip(self._places, blocks, strict=True):
            for place, values in zip(places, block, strict=False):
                if place >= 0:
                    columns[place] = values
        return self._target_beside(blocks)

    def _target_beside(self, blocks: Sequence[Array]) -> Array:
        """Return the target without what moving rows add that no linear parameter multiplies."""
        target = self._target
        for places, block in zip(self._places, blocks, strict=True):
            for place, values in zip(places, block, strict=False):
                if place < 0:
                    target = target - values
        return target

    @cached_property
    def _fixed_products(self) -> Array:
        """Products of the columns that do not depend on α; 0 beside the others."""
        return np.asarray(self._columns @ self._columns.T)

    def _products(self, columns: Array) -> Array:
        """Return the products of the columns of the linear parameters: new where they depend on α."""
        if len(self._moving) > _FEW:  # the symmetric product of all costs less
            return np.asarray(columns @ columns.T)
        gram = self._fixed_products.copy()
        for row in self._moving:
            gram[row] = gram[:, row] = columns @ columns[row]
        return gram

    def _solve(self, gram: Array, right: Array, target: Array) -> tuple[Array, float]:
        """Return the best linear parameters, and what was taken for noise of dω/dt in its square."""
        theta, noise, every, known = self._theta.copy(), 0.0, (gram, right), self._equations.acceleration_noise
        if self._held:
            right = (right - gram @ theta)[self._free]
            gram = gram[np.ix_(self._free, self._free)]
        normal = NormalEquations.of(gram, right)
        if known and 0 in self._free:
            plain = theta.copy()
            plain[self._free] = normal.solve(self._constraints, self._limits)
            left = float(target @ target + plain @ (every[0] @ plain - 2.0 * every[1]))
            noise = noise_of_first(known, plain, left)
            normal = NormalEquations.of(without_noise(gram, noise), right)
        theta[self._free] = normal.solve(self._constraints, self._limits)
        return theta, noise

    def at(self, alpha: Array) -> Solution:
        """Return the linear fit at given nonlinear parameters, with all derivatives."""
        split, n = self._equations.separable, self._width
        columns = np.empty((n + len(alpha), len(self._target)))
        linear, own = columns[:n], columns[n:]
        linear[:], own[:] = self._columns, 0.0
        blocks = self._blocks(alpha, slopes=True)
        target = self._moved(linear, blocks)
        products = self._products(linear)
        theta, noise = self._solve(products, linear @ target, target)
        slopes = [values for places, block in zip(self._places, blocks, strict=True) for values in block[len(places) :]]
        for (row, j), values in zip(split.slopes, slopes, strict=True):
            factor = 1.0 if row == len(split.linear) else theta[self._first + row]
            own[j] += factor * values
        whole = float(target @ target)
        for j in range(len(alpha)):
            if not own[j] @ own[j] * alpha[j] ** 2 <= _NOTHING * whole:
                continue
            pairs = [(self._first + row, v) for (row, i), v in zip(split.slopes, slopes, strict=True) if i == j]
            share = [v @ v / products[k, k] for k, v in pairs if k < self._nuisances and products[k, k] > 0.0]
            if own[j] @ own[j] <= _NOTHING**2 * whole * max(share, default=0.0):
                own[j] = 0.0
        residual = target - theta @ linear
        gram = np.empty((len(columns), len(columns)))
        gram[:n, :n] = products
        gram[n:] = own @ columns.T
        gram[:n, n:] = gram[n:, :n].T
        normal = NormalEquations.of(without_noise(gram, noise), columns @ residual)
        return Solution(theta, alpha, columns, residual, normal, 0, True)


def ranked(costs: Array) -> tuple[int, float]:
    """Return which of several costs is least, and how many times as much the next one is."""
    best = int(np.argmax(costs <= (1.0 + _EQUAL) * costs.min()))
    others = np.delete(costs, best)
    return best, float(others.min() / costs[best]) if costs[best] > 0.0 else math.inf


def _square(residual: Array) -> float:
    with np.errstate(invalid="ignore", over="ignore"):
        cost = float(residual @ residual)
    return cost if math.isfinite(cost) else math.inf


def _with_bounds(constraints: Array, limits: Array, bounds: Array) -> tuple[Array, Array]:
    """Return constraints and limits with further variables that have nothing but bounds."""
    more = len(bounds)
    if not more:
        return constraints, limits
    count, width = constraints.shape
    sides = [(i, side, 1.0 - 2.0 * side) for side in (0, 1) for i in range(more) if np.isfinite(bounds[i, side])]
    matrix, least = np.zeros((count + len(sides), width + more)), np.empty(count + len(sides))
    matrix[:count, :width], least[:count] = constraints, limits
    for row, (i, side, sign) in enumerate(sides, count):
        matrix[row, width + i], least[row] = sign, sign * bounds[i, side]
    return matrix, least
