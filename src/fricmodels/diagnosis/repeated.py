"""Searches that were made before: a ladder comes back to the same rows with the same question.

A model is examined when it is reached, and once more when others were tried; what explains most of its residual does
not change. The place of the optimum is kept as long as the rows, some numbers each; its columns are made anew from it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

from fricmodels.drive import Drive
from fricmodels.term import Effect
from fricmodels.weakform.candidate import Candidate, NonlinearOptimum
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.test_functions import TestFunctions

Plain = tuple[tuple[float, ...], float, float, bool]
"""Nonlinear parameters of an optimum, trials, delay, and whether it is at a bound of the search."""


@dataclass
class _Rows:
    """What was found in the rows of some test functions, and what these are of, held so that it stays what it is."""

    of: tuple[object, ...]
    found: dict[Hashable, Plain | None] = field(default_factory=dict)


_known: WeakKeyDictionary[TestFunctions, _Rows] = WeakKeyDictionary()


def once(
    problem: WeakFormProblem,
    regression: Regression,
    effect: Effect,
    alone: Drive,
    rival: float,
    find: Callable[[], NonlinearOptimum | None],
) -> NonlinearOptimum | None:
    """Return what a search finds, or what it found when the same was asked of the same rows.

    Args:
        problem, regression, effect, alone, rival: see :func:`fricmodels.weakform.search.search`.
        find: the search.
    """
    of = (problem.recording, problem.quadrature, problem.smooth, problem.resting)
    rows = _known.get(problem.test_functions)
    if rows is None or any(one is not other for one, other in zip(rows.of, of, strict=True)):
        rows = _known[problem.test_functions] = _Rows(of)
    key = (effect, alone.model, alone.inertia, rival, _asked(problem), _digest(regression))
    if key not in rows.found:
        found = find()
        rows.found[key] = None if found is None else plain(found)
        return found
    known = rows.found[key]
    return None if known is None else again(problem, regression, effect, alone, known)


def plain(found: NonlinearOptimum) -> Plain:
    """Return what an optimum is made from."""
    point = tuple(float(value) for value in found.nonlinear)
    return point, float(found.trials), float(found.delay), bool(found.at_search_bound)


def again(
    problem: WeakFormProblem, regression: Regression, effect: Effect, alone: Drive, known: Plain
) -> NonlinearOptimum:
    """Return an optimum that was found before, bit for bit."""
    point, trials, delay, at_search_bound = known
    rows = regression.unshifted if alone.model.delay else regression
    candidate = Candidate(problem, rows, effect, alone, delay)
    return candidate.found(tuple(point), trials, at_search_bound=at_search_bound)


def _asked(problem: WeakFormProblem) -> Hashable:
    """Return what else decides the columns and bounds of a candidate on the same rows."""
    estimated = None if problem.estimated is None else tuple(problem.estimated.items())
    drive = problem.drive
    known = (problem.friction_limits, problem.delay, problem.carriers, problem.shift, problem.held)
    return (drive.model, drive.inertia, drive.motion, estimated, *known)


def _digest(regression: Regression) -> bytes:
    """Return a hash of what the base directions leave of the target, and of their products with it."""
    content = hashlib.blake2b(type(regression).__name__.encode(), digest_size=16)
    content.update(regression.residual.tobytes())
    content.update((regression.base @ regression.target).tobytes())
    return content.digest()
