"""The rows of a weak-form problem as equations that variable projection solves."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.weakform.nonlinear import Nonlinear, Plan, linear_constraints, nonlinear_search
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.separable import SeparableTerm, separable
from fricmodels.weakform.variable_projection import Equations, Projection


def equations(problem: WeakFormProblem, *, timing: bool) -> Equations:
    """Return the equation of motion seen through the test functions of a problem.

    Args:
        problem: drive, recording and test functions.
        timing: whether reversals, and torque against motion, may be shifted in time by part of a sample; see
            :func:`timing_nuisances`.
    """
    split = separable(problem.drive.model)
    points = problem.points

    def moving(alpha: Array, slopes: bool) -> list[Array]:
        def rows(term: SeparableTerm, own: tuple[float, ...]) -> Array:
            def compute() -> Array:
                distinct = term.distinct_rows(points, np.array(own), problem.states_of, slopes=slopes)
                derivatives = term.distinct_derivatives(len(distinct))
                return term.completed(problem.integrals(distinct, derivatives), slopes=slopes)

            return problem.integrated((term.model, own, slopes), compute)

        return split.moving_blocks(alpha, rows)

    def fixed_rows() -> Array:
        derivatives = np.concatenate([term.fixed_derivatives for term in split.terms], axis=1)
        return problem.integrals(split.fixed_rows(points), derivatives)

    nuisances, limits = timing_nuisances(problem) if timing else (np.zeros((0, problem.rows)), np.zeros((0, 2)))
    return Equations(
        split,
        problem.driving,
        problem.target,
        problem.momentum if problem.drive.inertia is None else None,
        problem.integrated((problem.drive.model,), fixed_rows),
        moving,
        nuisances,
        limits,
        problem.momentum_noise if problem.drive.inertia is None else 0.0,
    )


def timing_nuisances(problem: WeakFormProblem) -> tuple[Array, Array]:
    """Return what a small shift in time adds to the rows, shape (m, rows), and its bounds, shape (m, 2).

    The instant of every reversal may be off by part of a sample. Torque and motion may be shifted against each other by
    up to one sample: a torque that is held between samples is so by half of one. A model with a delay of its own has
    no second one beside it.
    """
    rows, limits = [problem.sign_change], [(-np.inf, np.inf)]
    if "motor_torque_rate" not in problem.drive.model.needs:
        interval = problem.recording.interval
        rows.append(problem.torque_rate)
        limits.append((-interval, interval))
    return np.vstack(rows), np.array(limits)


def projection(problem: WeakFormProblem, plan: Plan, *, timing: bool) -> tuple[Projection, Nonlinear]:
    """Return the least-squares problem of a drive, and where its nonlinear parameters are sought.

    Args:
        problem: drive and rows.
        plan: where it begins, and what is held.
        timing: see :func:`equations`.
    """
    linear = [p for p in problem.drive.parameters if p.linear]
    constraints, limits = _constraints(problem.drive, problem.delay, _largest_push(problem.recording))
    held = {i: plan.held[p.key] for i, p in enumerate(linear) if p.key in plan.held}
    held |= dict(enumerate(plan.shifts, len(linear)))
    search = nonlinear_search(problem.drive, problem.recording, plan)
    return Projection(equations(problem, timing=timing), constraints, limits, held), search


@lru_cache(maxsize=64)
def _constraints(drive: Drive, delay: float, largest_push: float) -> tuple[Array, Array]:
    """Return :func:`linear_constraints` of a drive, found once for all sets of rows."""
    return linear_constraints([p for p in drive.parameters if p.linear], delay, largest_push, drive.inertia)


@once
def _largest_push(recording: Recording) -> float:
    """Return the largest torque that drives [N m or N]; a drive that coasts says nothing of it: ∞."""
    return float(np.max(np.abs(recording.driving_torque))) or np.inf
