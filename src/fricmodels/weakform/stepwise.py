"""Finds nonlinear parameters by steps in each, where the squared error has no slope that leads to its end."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from fricmodels.arrays import Array
from fricmodels.weakform.nonlinear import Nonlinear, Plan
from fricmodels.weakform.optimise import coordinate_search, multistart_nelder_mead
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.search import in_gap
from fricmodels.weakform.variable_projection import Projection, Solution

_NEARLY, _STARTED, _SCANNED = 1.05, 1.3, 2.0
"""First step of a nonlinear parameter, as a ratio: of one that is nearly known, has a start, or comes from a scan."""
_CLOSE = 0.25
"""First step of a wave number that is nearly known, in resolutions, and of an instant, in spacings; else it is one."""
_ROUNDS, _FEWER_ROUNDS = 5, 3
"""Rounds of a search by steps before Gauss–Newton goes on, and of one for what is nearly known."""
_TURNS = 4
"""Most turns between instants and all others."""


def by_steps(problem: WeakFormProblem, least_squares: Projection, search: Nonlinear, plan: Plan) -> Array:
    """Return the nonlinear parameters by steps in each: the error of a contact or of a jump in time is not smooth.

    The last steps are about a hundredth of a parameter, which may be many standard errors.
    """
    chosen = [p for p in problem.drive.parameters if not p.linear]
    points = [search.clip(point) for point in search.combinations()]
    begin = min(points, key=least_squares.cost) if len(points) > 1 else points[0]
    bounds = list(zip(search.lower.tolist(), search.upper.tolist(), strict=True))
    started = _NEARLY if plan.nearly else _STARTED
    spacing = [
        1.0
        if held
        else -(_CLOSE if plan.nearly else 1.0) * reach
        if p.declared.periodic or p.declared.instant
        else (started if p.key in plan.start else _SCANNED)
        for p, held, reach in zip(chosen, search.held, search.reach.tolist(), strict=True)
    ]

    @cache
    def value(point: tuple[float, ...]) -> float:
        return -least_squares.cost_beside(np.array(point))

    start = tuple(begin.tolist())
    if len(points) > 1 and len(chosen) > 2:  # many summits: from several of the values that are tried first
        hopeful = sorted((tuple(point.tolist()) for point in points), key=value, reverse=True)
        scanned = all(values[0] > 0.0 for values in search.starts)
        start = multistart_nelder_mead(value, hopeful, bounds, spacing, patience=1) if scanned else start
    rounds = _FEWER_ROUNDS if plan.nearly else _ROUNDS
    return np.array(coordinate_search(value, start, bounds, spacing, rounds))


def to_the_end(problem: WeakFormProblem, least_squares: Projection, search: Nonlinear, alpha: Array) -> Solution:
    """Return the least squares next to a point: by samples in each instant, by Gauss–Newton in all others."""
    instants = np.array([p.declared.instant for p in problem.drive.parameters if not p.linear], dtype=bool)
    free = np.flatnonzero(instants & ~search.held)
    search = replace(search, held=search.held | instants)
    for _ in range(_TURNS):
        solution = least_squares.descend(least_squares.at(alpha), search)
        if not len(free):
            return solution
        alpha = solution.alpha.copy()
        for own in free.tolist():
            alpha[own] = _least_instant(problem, least_squares, search, alpha, own)
        if np.array_equal(alpha, solution.alpha):
            break
    return replace(solution, settled=False)


def _least_instant(
    problem: WeakFormProblem, least_squares: Projection, search: Nonlinear, alpha: Array, own: int
) -> float:
    """Return the middle between two samples that leaves least, from steps of a row's width down to one sample."""
    time = np.unique(problem.recording.time)
    middles = 0.5 * (time[1:] + time[:-1])
    first, last = np.searchsorted(middles, (search.lower[own], search.upper[own])).tolist()
    last = max(last - 1, first)

    @cache
    def left(place: int) -> float:
        return least_squares.cost_beside(np.where(np.arange(len(alpha)) == own, middles[place], alpha))

    place, step = int(np.clip(np.searchsorted(time, alpha[own]) - 1, first, last)), problem.test_functions.width
    while step:
        better = min((place, max(place - step, first), min(place + step, last)), key=left)
        place, step = (better, step) if better != place else (place, step // 2)
    return in_gap(float(middles[place]), time, problem.test_functions.width * problem.recording.interval)
