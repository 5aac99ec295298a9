"""Solves the rows of a problem for all parameters of its drive, with a small shift in time or without."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmodels.recording import Recording
from fricmodels.signals.rest import once
from fricmodels.weakform.equations import projection
from fricmodels.weakform.inference import at_least, covariance
from fricmodels.weakform.instants import instant_error
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import cosine_terms
from fricmodels.weakform.staircase import scatter_of_steps
from fricmodels.weakform.stepwise import by_steps, to_the_end
from fricmodels.weakform.variable_projection import THINNED, Solution, ranked

Array = NDArray[np.float64]

_NEARLY_ALL, _MUCH_MORE = 0.9, 2.0
"""Share of the rows that two sets have in common, to tell which start leaves least of either, and how many times as
much the next best start must leave."""
STRONG = 3.0
"""Logarithm of 20 to 1: strong evidence on the scale of Kass and Raftery (1995)."""
WITHIN = 0.999
"""Share of a sample up to which a shift is within its bound."""
_NO_FRICTION = 1e-9
"""A Coulomb torque of less than this share of the largest torque is none."""
_TRUE_TO, _HELD_TO = 0.025, 0.005
"""A twentieth and a hundredth of a sample, in units of two samples: how true instants are if there is no shift, and if
the torque is held. By another twentieth the inertia torque, ten times the viscous one, would change K_v by a tenth."""


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
    """

    problem: WeakFormProblem
    plan: Plan
    solution: Solution
    timing: bool
    others: tuple[tuple[Solved, float], ...] = ()
    not_identified: Mapping[str, str] = field(default_factory=dict)
    free: Solved | None = None
    feedback: Array | None = None

    def changed(self, **changes: Any) -> Solved:
        """Return a copy with other attributes than the rows, the plan or the solution; what these show is kept."""
        copy = replace(self, **changes)
        for name in ("places", "values", "_spread", "with_shift", "_known_odds"):
            if name in self.__dict__:
                copy.__dict__[name] = self.__dict__[name]
        return copy

    @cached_property
    def places(self) -> NDArray[np.int64]:
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
        nuisances = self._nuisances
        held = 0.5 * self.problem.recording.interval if self.problem.held else 0.0
        return held + (float(self.solution.theta[nuisances[-1]]) if bounded and len(nuisances) else 0.0)

    @property
    def _nuisances(self) -> NDArray[np.int64]:
        linear = sum(p.linear for p in self.problem.drive.parameters)
        return np.arange(linear, len(self.solution.theta))

    @cached_property
    def _spread(self) -> Array:
        """Covariance in the order of the solution; 0 for what is held."""
        solution, (free, normal) = self.solution, self._free
        result = np.zeros((len(solution.jacobian),) * 2)
        jacobian = solution.jacobian if len(free) == len(result) else solution.jacobian[free]
        found = covariance(jacobian.T, solution.residual, normal.inverse, self.problem.independent)
        scatter = scatter_of_steps(self.problem, self.parameters)
        if len(scatter):
            moved = scatter @ jacobian.T @ normal.inverse
            found = at_least(found, moved.T @ moved / len(scatter))
        result[np.ix_(free, free)] = found
        return result

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
    def _free(self) -> tuple[NDArray[np.int64], NormalEquations]:
        """Places in the solution of what is not held, and the normal equations of these."""
        solution, held = self.solution, self._held
        free = np.array([i for i in range(len(solution.jacobian)) if i not in held], dtype=np.int64)
        return free, solution.normal if len(free) == len(solution.jacobian) else solution.part(free)

    @property
    def _held(self) -> set[int]:
        keys = self.problem.drive.keys
        parameters = self.problem.drive.parameters
        fixed = {int(self.places[i]) for i, p in enumerate(parameters) if p.declared.constant or p.declared.instant}
        return {int(self.places[keys.index(key)]) for key in self.plan.held} | fixed

    @cached_property
    def _instants(self) -> dict[int, float]:
        """Place among the drive's parameters → standard error [s] of each instant that is not held."""
        drive, linear = self.problem.drive, len(self.solution.theta)
        if not any(p.declared.instant for p in drive.parameters):
            return {}
        least_squares, _ = projection(self.problem, self.plan, timing=self.timing)
        errors, alpha = {}, self.solution.alpha

        def cost(own: int, instant: float) -> float:
            return least_squares.cost(np.where(np.arange(len(alpha)) == own, instant, alpha))

        for i, p in enumerate(drive.parameters):
            if p.declared.instant and p.key not in self.plan.held:
                own = int(self.places[i]) - linear
                instant, certain = float(alpha[own]), self._certain
                errors[i] = instant_error(self.problem.recording, partial(cost, own), instant, certain)
        return errors

    @property
    def _certain(self) -> float:
        """Independent equations less the parameters, over by how much variances exceed those of independent errors."""
        solution, independent = self.solution, self.problem.independent
        free, normal = self._free
        own, plain = np.diag(self._spread)[free], np.diag(normal.inverse) * solution.cost / independent
        exceed = np.divide(own, plain, out=np.ones(len(free)), where=plain > 0.0)
        return max(independent - len(solution.jacobian), 1.0) / max(1.0, float(np.max(exceed, initial=1.0)))

    @property
    def undetermined(self) -> Array:
        """Directions that change nothing, in the order of the drive's parameters, (n, any number); of nothing held."""
        free, normal = self._free
        found = np.zeros((len(self.solution.jacobian), normal.null.shape[1]))
        found[free] = normal.null
        loose = np.eye(len(self.values))[:, [i for i, error in self._instants.items() if error == math.inf]]
        return np.hstack([found[self.places], loose])

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimates: over all choices of nuisances, by their probability, with what they differ."""
        if self.free is not None:
            return self.free.covariance
        result = _with_feedback(self._spread[np.ix_(self.places, self.places)], self.feedback)
        result *= 1.0 - sum(weight for _, weight in self.others)
        for other, weight in self.others:
            apart = self.values - other.values
            result += weight * (other._spread[np.ix_(other.places, other.places)] + np.outer(apart, apart))
        for i, error in self._instants.items():
            result[i, i] += error**2 if error < math.inf else 0.0
        return result

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each estimated parameter."""
        spread = np.sqrt(np.clip(np.diag(self.covariance), 0.0, None))
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
        return 100 * float(np.linalg.norm(self.solution.residual) / np.linalg.norm(self.problem.driving))

    @property
    def message(self) -> str:
        """Why the fit did not end well; empty where it did."""
        solution = self.solution
        return "" if solution.converged else f"no minimum after {solution.iterations} iterations"

    def log_odds_of_held(self, *, reversals: bool = True) -> float:
        """Return the logarithm of how much more probable a torque that is held between samples is than another."""
        whole = self.log_odds_of_a_shift(reversals=reversals)
        of_held = self.log_odds_of_a_shift(reversals=reversals, than=0.5)
        return whole - of_held if math.isfinite(whole) and math.isfinite(of_held) else 0.0

    def log_odds_of_a_shift(self, *, reversals: bool = True, than: float = 0.0) -> float:
        r"""Return the logarithm of how much more probable a shift in time is than none, or than a given one.

        A shift is equally probable anywhere within a sample either way; with none, instants are true to a twentieth of
        a sample, s, and to a hundredth where the torque is held: the samples of a controller need no other clock. With
        an estimate n in units of what is possible before anything was measured, its variance V from ν cosines, and
        :math:`S = V + s^2`,

        .. math:: \ln\frac{P(\text{shift})}{P(\text{none})} = \tfrac{\nu + 1}2 \ln\Bigl(1 + \frac{n^2}{\nu S}\Bigr)
                  + \tfrac12 \ln(2\pi S)

        summed over the nuisances, along the axes of their covariance.

        Args:
            reversals: whether their instants count as well, or only that of the torque against the motion. A smoothed
                velocity turns at another instant, whatever the recording.
            than: the shift of the torque against which it is judged [samples]; half a one is that of a held torque.

        Source: R. E. Kass, A. E. Raftery, "Bayes factors", J. Amer. Statist. Assoc. 90 (1995), with Student's t for a
        variance that is estimated.
        """
        known = self._known_odds
        if (reversals, than) not in known:
            known[reversals, than] = self._log_odds(reversals, than)
        return known[reversals, than]

    @cached_property
    def _known_odds(self) -> dict[tuple[bool, float], float]:
        return {}

    def _log_odds(self, reversals: bool, than: float) -> float:
        nuisances = self._nuisances
        sizes = np.full(len(nuisances), 2 * self.problem.recording.interval)
        centre, true_to = np.zeros(len(nuisances)), np.full(len(nuisances), _TRUE_TO)
        if than and "motor_torque_rate" not in self.problem.drive.model.needs:
            centre[-1:], true_to[-1:] = than * self.problem.recording.interval, _HELD_TO
        if len(nuisances):  # in samples, times the Coulomb torque: without that no reversal can be shifted
            sizes[0] = 2 * self.problem.friction_limits[1]
            torque = _largest_torque(self.problem.recording)
            some = np.append(sizes[:1] > _NO_FRICTION * torque, np.ones(len(sizes) - 1, dtype=bool))
            some[0] &= reversals
            # At its bound a shift is of unknown size, and speaks for none.
            some[-1] &= abs(self.shift) < WITHIN * self.problem.recording.interval
            nuisances, sizes, centre, true_to = nuisances[some], sizes[some], centre[some], true_to[some]
        own = self._spread[np.ix_(nuisances, nuisances)] / np.outer(sizes, sizes)
        estimate = (self.solution.theta[nuisances] - centre) / sizes
        seen = (np.diag(own) > 0.0) & np.any(self.solution.jacobian[nuisances] != 0.0, axis=1)
        total, axes = np.linalg.eigh(own[np.ix_(seen, seen)] + np.diag(true_to[seen] ** 2))
        along = axes.T @ estimate[seen]
        known = 2 * math.pi * total < 1.0  # what is known worse than all that is possible says nothing
        freedom = cosine_terms(self.problem.independent, self.problem.rows)
        return float(np.sum(_odds(along[known], total[known], freedom))) if known.any() else -math.inf

    @property
    def could_be_shifted(self) -> bool:
        """Whether there could be strong evidence for a shift of the torque against the motion, were only that known.

        The odds are greatest where the shift has no variance, or as much as leaves it known at all: no covariance is
        needed to say that there is none.
        """
        nuisances = self._nuisances
        if not len(nuisances) or "motor_torque_rate" in self.problem.drive.model.needs:
            return False
        size = float(self.solution.theta[nuisances[-1]]) / (2 * self.problem.recording.interval)
        freedom = cosine_terms(self.problem.independent, self.problem.rows)
        return bool(np.any(_odds(size, np.array([_TRUE_TO**2, 1.0 / (2 * math.pi)]), freedom) > STRONG))


@once
def _largest_torque(recording: Recording) -> float:
    """Return the largest motor torque [N m or N]."""
    return float(np.max(np.abs(recording.torque)))


def _odds(estimate: Array | float, variance: Array, freedom: int) -> Array:
    """Return the logarithm of how much more probable a shift is than none; see :meth:`Solved.log_odds_of_a_shift`."""
    squares = np.log1p(np.square(estimate) / (freedom * variance))
    return np.asarray(0.5 * (freedom + 1) * squares + 0.5 * np.log(2 * math.pi * variance))


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
    both = found.problem.bumps.in_common(problem.bumps) if along else np.zeros(0, dtype=np.int64)
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
