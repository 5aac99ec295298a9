"""Solves the rows of a problem for all parameters of its drive, with a small shift in time or without."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Index, deviations
from fricmodels.weakform.acting import acting
from fricmodels.weakform.equations import projection
from fricmodels.weakform.inference import NORMAL_95, at_least, covariance, covariance_once
from fricmodels.weakform.instants import likely_instants
from fricmodels.weakform.known_delay import variance_of_instants
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.likely_values import likely_error, likely_points
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.optimise import Point
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.staircase import scatter_of_steps
from fricmodels.weakform.stepwise import by_steps, to_the_end
from fricmodels.weakform.variable_projection import THINNED, Projection, Solution, ranked
from fricmodels.weakform.wandering import scatter_of_position

_FEW, _SIGNED = 2, 0.25
"""Of more nonlinear parameters than these likely ones are sought together, those of either sign so far away."""
_ENDLESS = 1e100
"""What the steps of a sensor may move a parameter by that nothing determines; its square is still a number."""
_ROUGH = 1.2
"""Times its standard error to which a parameter is likely, from which on an error is not smooth."""
_NEARLY_ALL, _MUCH_MORE = 0.9, 2.0
"""Share of the rows that two sets have in common, to tell which start leaves least of either, and how many times as
much the next best start must leave."""
WITHIN = 0.999
"""Share of a sample up to which a shift is within its bound."""


@dataclass(frozen=True)
class Solved:
    """A fit to the rows of a problem.

    Attributes:
        problem: the rows.
        plan: starts, and what is held.
        solution: in the order inertia, linear parameters, nuisances, nonlinear parameters.
        timing: whether it has nuisances.
        others: fits with another course of the torque between samples or another choice of nuisances, each with its
            probability.
        not_identified: key → reason.
        free: the fit with nothing held, whose covariance counts: what is held is not known to be so.
        feedback: by how much an error grows, because the rows follow the fit, shape (n, n); see :mod:`.model_velocity`.
        of_shifts: covariance by what the nuisances may be that the plan holds, in the order of the drive's parameters.
    """

    problem: WeakFormProblem
    plan: Plan
    solution: Solution
    timing: bool
    others: tuple[tuple[Solved, float], ...] = ()
    not_identified: Mapping[str, str] = field(default_factory=dict)
    free: Solved | None = None
    feedback: Array | None = None
    of_shifts: Array | None = None

    def changed(self, **changes: Any) -> Solved:
        """Return a copy with other attributes than the rows, the plan or the solution; what these show is kept."""
        copy = replace(self, **changes)
        for name in ("places", "values", "spread", "_by_rows", "with_shift", "known_odds"):
            if name in self.__dict__ and not (name == "spread" and "of_shifts" in changes):
                copy.__dict__[name] = self.__dict__[name]
        if "of_shifts" in changes:
            copy.__dict__["_by_rows"] = self._by_rows
        return copy

    @cached_property
    def places(self) -> Index:
        """Place in the solution of each of the drive's parameters."""
        flags = [p.linear for p in self.problem.drive.parameters]
        linear = iter(range(sum(flags)))
        nonlinear = iter(range(len(self.solution.theta), len(self.solution.jacobian)))
        return np.array([next(linear if flag else nonlinear) for flag in flags], dtype=np.int64)

    @cached_property
    def values(self) -> Array:
        """The estimates in the order of the drive's parameters."""
        drive = self.problem.drive
        values = np.concatenate([self.solution.theta, self.solution.alpha])[self.places]
        for i, p in enumerate(drive.parameters):
            gone = self.problem.delay if p.declared.delay else 0.0
            values[i] = min(max(values[i] + gone, p.declared.lower), p.declared.upper)
            if p.at_least in drive.keys:
                values[i] = max(values[i], values[drive.keys.index(p.at_least)])
        return values

    @property
    def parameters(self) -> dict[str, float]:
        """Value of every parameter by key, the inertia among them."""
        drive = self.problem.drive
        found = dict(zip(drive.keys, self.values.tolist(), strict=True))
        found.setdefault(drive.inertia_key, drive.inertia if drive.inertia is not None else float("nan"))
        return found

    @property
    def shift(self) -> float:
        """Time [s] by which motion was recorded after the torque: of a held one half a sample."""
        bounded = "motor_torque_rate" not in self.problem.drive.model.needs
        nuisances = self.nuisances
        held = 0.5 * self.problem.recording.interval if self.problem.held else 0.0
        return held + (float(self.solution.theta[nuisances[-1]]) if bounded and len(nuisances) else 0.0)

    @cached_property
    def nuisances(self) -> Index:
        """Places of the nuisances in the solution."""
        linear = sum(p.linear for p in self.problem.drive.parameters)
        return np.arange(linear, len(self.solution.theta))

    @cached_property
    def known_odds(self) -> dict[Hashable, float]:
        """What :mod:`.shift_evidence` has found, by what was asked."""
        return {}

    @cached_property
    def spread(self) -> Array:
        """Covariance in the order of the solution; 0 for what is held."""
        free, _ = self._free
        result = np.zeros((len(self.solution.jacobian),) * 2)
        result[np.ix_(free, free)] = self._by_rows
        if self.of_shifts is not None:
            result[np.ix_(self.places, self.places)] += self.of_shifts
        return result

    @cached_property
    def _by_rows(self) -> Array:
        """Covariance of what is not held, as the rows show it: whatever the nuisances may be that are held."""
        solution, (free, normal) = self.solution, self._free
        jacobian = solution.jacobian if len(free) == len(solution.jacobian) else solution.jacobian[free]
        found = covariance(jacobian.T, solution.residual, normal.inverse, self.problem.independent)
        parts = self.problem.repeats
        if parts is not None:
            once = covariance_once(jacobian.T, solution.residual, normal.inverse, self.problem.independent, parts)
            found = found if once is None else at_least(found, once)
        scatters = [each for each in scatter_of_steps(self.problem, self.parameters) if len(each)]
        if scatters:
            found = at_least(found, sum(map(self._variance_by, scatters), np.zeros_like(found)))
        wandering = scatter_of_position(self.problem, self.parameters)
        if len(wandering):  # the residual shows little of it
            found = found + self._variance_by(wandering)
        return found

    def _variance_by(self, scatter: Array) -> Array:
        """Return the covariance that errors of a sensor make, which may be any of those that move the rows so."""
        free, normal = self._free
        moved = scatter @ self.solution.jacobian[free].T @ normal.inverse / np.sqrt(len(scatter))
        moved = np.clip(moved, -_ENDLESS, _ENDLESS)
        return np.asarray(moved.T @ moved)

    def left_by(self, values: Array) -> float:
        """Return the sum of squares that other parameters leave of the rows, with the best nuisances."""
        held = dict(zip(self.problem.drive.keys, values.tolist(), strict=True))
        least_squares, search = projection(self.problem, Plan(held=held), timing=self.timing)
        return least_squares.cost(least_squares.best_start(search))

    def moved_by(self, left: Array) -> Array:
        """Return by how much the estimates move with what is left of the rows, shape (k, rows) → (n, k)."""
        solution, (free, normal) = self.solution, self._free
        moved = np.zeros((len(solution.jacobian), len(left)))
        moved[free] = normal.inverse @ (solution.jacobian[free] @ left.T)
        return moved[self.places]

    @cached_property
    def _free(self) -> tuple[Index, NormalEquations]:
        """Places in the solution of what is not held, and the normal equations of these."""
        solution, held = self.solution, self._held
        free = np.array([i for i in range(len(solution.jacobian)) if i not in held], dtype=np.int64)
        return free, solution.normal if len(free) == len(solution.jacobian) else solution.part(free)

    @property
    def _held(self) -> set[int]:
        keys = self.problem.drive.keys
        parameters = self.problem.drive.parameters
        fixed = {int(self.places[i]) for i, p in enumerate(parameters) if p.declared.constant or p.declared.instant}
        shifts = set(self.nuisances.tolist()) if self.plan.shifts else set()
        return {int(self.places[keys.index(key)]) for key in self.plan.held} | fixed | shifts

    @cached_property
    def _instants(self) -> dict[int, tuple[float, Sequence[Solved]]]:
        """Place among the drive's parameters → standard error [s] of each instant that is not held, and the fits at
        other likely instants."""
        drive, linear = self.problem.drive, len(self.solution.theta)
        if not any(p.declared.instant for p in drive.parameters):
            return {}
        least_squares, _ = projection(self.problem, self.plan, timing=self.timing)
        found: dict[int, tuple[float, Sequence[Solved]]] = {}
        alpha = self.solution.alpha

        def at(own: int, instant: float) -> Array:
            return np.where(np.arange(len(alpha)) == own, instant, alpha)

        for i, p in enumerate(drive.parameters):
            if p.declared.instant and p.key not in self.plan.held:
                own = int(self.places[i]) - linear

                def cost(instant: float, own: int = own) -> float:
                    return least_squares.cost(at(own, instant))

                likely = likely_instants(self.problem.recording, cost, float(alpha[own]), self._certain)
                fits = (replace(self, solution=least_squares.at(at(own, one))) for one in likely.within)
                found[i] = likely.error, list(fits)
        return found

    def holding(self, key: str, value: float) -> Plan:
        """Return the plan to hold one more parameter; an instant begins at the likely one that then leaves least."""
        plan = replace(self.plan, held={**self.plan.held, key: value})
        for i, (_, fits) in self._instants.items():
            least_squares, _ = projection(self.problem, plan, timing=self.timing)
            tried = [fit.solution.alpha for fit in (self, *fits)]
            best = min(tried, key=least_squares.cost)
            own = int(self.places[i]) - len(self.solution.theta)
            plan = replace(plan, start={**plan.start, self.problem.drive.keys[i]: float(best[own])})
        return plan

    @property
    def _certain(self) -> float:
        """Independent equations less the parameters, over by how much variances exceed those of independent errors."""
        solution, independent = self.solution, self.problem.independent
        free, normal = self._free
        own, plain = np.diag(self.spread)[free], np.diag(normal.inverse) * solution.cost / independent
        exceed = np.divide(own, plain, out=np.ones(len(free)), where=plain > 0.0)
        return max(independent - len(solution.jacobian), 1.0) / max(1.0, float(np.max(exceed, initial=1.0)))

    @property
    def undetermined(self) -> Array:
        """Directions that change nothing, in the order of the drive's parameters, (n, any number); of nothing held.

        What changes nothing at another likely instant is among them.
        """
        loose = np.eye(len(self.values))[:, [i for i, (error, _) in self._instants.items() if error == math.inf]]
        fits = [self, *(fit for _, fits in self._instants.values() for fit in fits)]
        return np.hstack([max((fit._null for fit in fits), key=lambda null: null.shape[1]), loose])

    @property
    def _null(self) -> Array:
        """Directions that change nothing at these instants."""
        free, normal = self._free
        found = np.zeros((len(self.solution.jacobian), normal.null.shape[1]))
        found[free] = normal.null
        return found[self.places]

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimates: over all choices of nuisances, by their probability, with what they differ."""
        if self.free is not None:
            return self.free.covariance
        result = _with_feedback(self.spread[np.ix_(self.places, self.places)], self.feedback)
        result *= 1.0 - sum(weight for _, weight in self.others)
        for other, weight in self.others:
            apart = self.values - other.values
            result += weight * (other.spread[np.ix_(other.places, other.places)] + np.outer(apart, apart))
        for i, (error, fits) in self._instants.items():
            for fit in fits:
                apart = np.where(np.arange(len(result)) == i, 0.0, fit.values - self.values) / NORMAL_95
                result = at_least(result, fit.spread[np.ix_(self.places, self.places)] + np.diag(apart**2))
            result[i, i] += error**2 if error < math.inf else 0.0
        result += np.diag(variance_of_instants(self.problem, self.plan.held))
        return self._at_least_likely(result) if self.problem.drive.model.states else result

    def _at_least_likely(self, result: Array) -> Array:
        """Return a covariance in which nonlinear parameters may be off as far as they are likely, see
        :mod:`.likely_values`."""
        linear, alpha = len(self.solution.theta), self.solution.alpha
        least_squares, _ = projection(self.problem, self.plan, timing=self.timing)
        wanted = np.diag(result).copy()
        for i, p in enumerate(self.problem.drive.parameters):
            if p.linear or p.declared.instant or p.key in self.plan.held:
                continue
            own = int(self.places[i]) - linear

            def cost(value: float, own: int = own) -> float:
                return least_squares.cost(np.where(np.arange(len(alpha)) == own, value, alpha))

            bounds, error = (p.declared.lower, p.declared.upper), math.sqrt(max(wanted[i], 0.0))
            wanted[i] = max(wanted[i], likely_error(cost, float(alpha[own]), error, bounds, self._certain) ** 2)
        if np.any(wanted > _ROUGH**2 * np.diag(result)):
            for fit in self._likely_elsewhere(least_squares):
                wanted = np.maximum(wanted, ((fit.values - self.values) / NORMAL_95) ** 2)
        return at_least(result, np.diag(wanted))

    def _likely_elsewhere(self, least_squares: Projection) -> Iterator[Solved]:
        """Yield the fits at the outermost likely parameters of terms with memory, where more than two of them trade."""
        alpha, drive = self.solution.alpha, self.problem.drive
        memories = tuple(f"{effect.name}." for effect in drive.model.effects if effect.states)
        nonlinear = [p for p in drive.parameters if not p.linear]
        reach = [0.0 if p.declared.lower >= 0.0 else _SIGNED for p in nonlinear]
        for i, p in enumerate(nonlinear):
            if p.key in self.plan.held or p.declared.constant or not p.key.startswith(memories):
                reach[i] = -1.0
        if sum(far >= 0.0 for far in reach) <= _FEW:
            return
        bounds = [(p.declared.lower, p.declared.upper) for p in nonlinear]

        def cost(point: Point) -> float:
            return least_squares.cost_beside(np.array(point))

        samples = len(self.problem.recording)
        for point in likely_points(cost, tuple(alpha.tolist()), bounds, reach, self._certain, samples):
            yield replace(self, solution=least_squares.at(np.array(point)))

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each estimated parameter."""
        spread = deviations(self.covariance)
        return dict(zip(self.problem.drive.keys, spread.tolist(), strict=True))

    @property
    def again(self) -> Plan:
        """The same plan, to begin from what was found."""
        nonlinear = {p.key for p in self.problem.drive.parameters if not p.linear}
        start = {key: value for key, value in self.parameters.items() if key in nonlinear}
        return replace(self.plan, start=start, nearly=True)

    @cached_property
    def with_shift(self) -> Solved:
        """The fit to the same rows with a small shift in time, begun from this one."""
        return self.once_more(self.again, timing=True)

    def once_more(self, plan: Plan, *, timing: bool) -> Solved:
        """Return the fit to the same rows by another plan: this one itself, where it would begin and end here."""
        if timing == self.timing and plan == self.again and self.solution.settled:
            return self.changed(plan=plan, others=(), not_identified={}, free=None)
        return solve(self.problem, plan, timing=timing)

    @property
    def residual_percent(self) -> float:
        """RMS of what is left of the rows, of the RMS driving torque in them."""
        return 100 * float(np.linalg.norm(self.solution.residual) / np.linalg.norm(acting(self.problem)))

    @property
    def message(self) -> str:
        """Why the fit did not end well; empty where it did."""
        solution = self.solution
        return "" if solution.converged else f"no minimum after {solution.iterations} iterations"


def _with_feedback(covariance: Array, feedback: Array | None) -> Array:
    """Return the covariance of a fixed point, F V F'; what is held stays without a variance."""
    if feedback is None:
        return covariance
    free = np.diag(covariance) > 0.0
    return np.asarray(np.where(free & free[:, None], feedback @ covariance @ feedback.T, 0.0))


def solve(problem: WeakFormProblem, plan: Plan, *, timing: bool = True) -> Solved:
    """Fit a drive to the rows of a problem.

    Args:
        problem: drive and rows.
        plan: starts of nonlinear parameters, and what is held.
        timing: whether reversals, and torque against motion, may be shifted by part of a sample.
    """
    least_squares, search = projection(problem, plan, timing=timing)
    if problem.drive.model.states or any(p.declared.instant for p in problem.drive.parameters):
        solution = to_the_end(problem, least_squares, search, by_steps(problem, least_squares, search, plan))
    else:
        solution = least_squares.solve(search)
    return Solved(problem, plan, solution, timing)


def begins_where(problem: WeakFormProblem, plan: Plan, found: Solved) -> bool:
    """Whether a fit to the rows of a problem would begin from the same nonlinear parameters as an earlier one.

    Where the earlier rows are nearly all the same, and leave much more of the motor torque with any other start, those
    that both have tell it: what each start leaves of them is known.
    """
    start, scan = found.solution.start, found.solution.scan
    if start is None:
        return False
    along = found.problem.smooth is problem.smooth and plan == found.plan
    both = found.problem.test_functions.in_common(problem.test_functions) if along else np.zeros(0, dtype=np.int64)
    if len(both) > _NEARLY_ALL * max(problem.rows, found.problem.rows):
        if scan is None:
            return True
        left = scan.left[:, both[both % THINNED == 0] // THINNED]
        with np.errstate(invalid="ignore", over="ignore"):
            costs = np.nan_to_num(np.einsum("ij,ij->i", left, left), nan=np.inf, posinf=np.inf)
        best, more = ranked(costs)
        if more > _MUCH_MORE:
            return bool(np.array_equal(scan.points[best], start))
    least_squares, search = projection(problem, plan, timing=found.timing)
    return bool(np.array_equal(least_squares.best_start(search), start))
