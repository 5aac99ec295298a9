"""Climbs to the summit of a function of a few physical parameters, which may lie on a long and narrow ridge."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fricmodels.arrays import Array

Point = tuple[float, ...]
Bounds = tuple[float, float]

ROUNDS = 7
"""Rounds of a coordinate search; each halves the steps."""
_LONGEST_WALK = 12
"""Most steps in one direction."""
_STARTS, _GLANCE = 12, 12
"""Number of simplexes begun, and evaluations each."""
_BEST, _SHORT = 8, 28
"""Number of simplexes continued, and further evaluations each."""
_UNLIKELY = 0.25
"""A search ends if by then no simplex has reached this share of the value that makes it worth going on."""
_TOO_LOW = 0.0625
"""It does not begin where no start has this share of that value."""
_LONG, _ENOUGH = 150, 0.003
"""Evaluations of each restart of the best simplex. It is restarted as long as that raises the value by this share."""
_EDGE, _EDGES = 0.5, (0.25, 0.5) * 4
"""Edge of a simplex at first, and at each restart, in spacings of the points tried before."""
_EQUAL = 1e-9
"""Share by which values that are equal but for rounding may differ: the first of them is taken."""
_SURE = 1e-4
"""A simplex has converged when its corners differ by this share of the value and of an edge."""
_NEWTON_STEPS = 8
"""Most Newton steps that refine an optimum."""
_WIDE, _NARROW = 0.05, 1e-3
"""Largest and smallest distance of the points that give the derivatives, in spacings."""
_CONVERGED = 1e-7
"""A Newton step shorter than this, in spacings, is the last."""
_SHORTENED = (1.0, 0.25, 0.0625)
"""Parts of a Newton step that are tried until one raises the value."""


def coordinate_search(
    value: Callable[[Point], float],
    point: Point,
    bounds: Sequence[Bounds],
    spacing: Sequence[float],
    rounds: int = ROUNDS,
) -> Point:
    """Climb from a point, each parameter in turn, by steps that halve each round, and then along what a round moved.

    Args:
        value: what is to be made large.
        point: where to begin.
        bounds: of each parameter.
        spacing: first step of each parameter: a ratio if positive, a difference if negative.
        rounds: how often the steps are tried; they are halved in between.
    """
    steps = list(spacing)
    best = value(point)
    for _ in range(rounds):
        begin = point
        for i, (lower, upper) in enumerate(bounds):
            for direction in (-1, 1):
                moves = 0
                while moves < _LONGEST_WALK:
                    here, step = point[i], steps[i]
                    moved = here - direction * step / 2 if step < 0 else here * step ** (direction / 2)
                    moved = min(max(moved, lower), upper)
                    trial = (*point[:i], moved, *point[i + 1 :])
                    reached = value(trial) if moved != here else best
                    if reached <= best:
                        break
                    point, best, moves = trial, reached, moves + 1
                if moves:
                    break
        last = begin
        for _ in range(_LONGEST_WALK if sum(a != b for a, b in zip(begin, point, strict=True)) > 1 else 0):
            trial = tuple(map(_onward, last, point, bounds, steps))
            reached = value(trial)
            if reached <= best:
                break
            last, point, best = point, trial, reached
        steps = halved(steps)
    return point


def halved(spacing: Sequence[float], times: int = 1) -> list[float]:
    """Return steps, ratios if positive and else differences, after so many halvings."""
    part = 0.5**times
    return [step * part if step < 0 else step**part for step in spacing]


def _onward(last: float, here: float, bounds: Bounds, step: float) -> float:
    """Return where the same move again leads."""
    moved = 2 * here - last if step < 0 or here * last <= 0 else here * here / last
    return min(max(moved, bounds[0]), bounds[1])


def multistart_nelder_mead(
    value: Callable[[Point], float],
    starts: Sequence[Point],
    bounds: Sequence[Bounds],
    spacing: Sequence[float],
    worth: float = -math.inf,
    patience: int = 0,
) -> Point:
    """Climb from several points, all parameters together, for many of them have many summits and narrow ridges.

    Source: Nelder and Mead (1965), in logarithms of parameters whose spacing is a ratio.

    Args:
        value: what is to be made large; it is asked again for some points, so that it should remember them.
        starts: where to begin, the most hopeful first.
        bounds: of each parameter.
        spacing: of what was tried before in each parameter: a ratio if positive, a difference if negative; one that
            makes no difference has a ratio of 1 and stays.
        worth: a value below which the search is not worth going on: where no simplex comes near it at once, or the
            best one does not reach it, it is given up. How far the simplexes had come then hangs on the last digits;
            what is returned is the best of the starts.
        patience: how many more times it is begun anew where that did not raise the value.
    """
    from scipy.optimize import minimize

    free = [i for i, step in enumerate(spacing) if step != 1.0]
    highest = max(map(value, starts))
    first = next((start for start in starts if value(start) >= highest - _EQUAL * abs(highest)), starts[0])
    if not free or highest < _TOO_LOW * worth:
        return first
    unit = [-spacing[i] if spacing[i] < 0 else math.log(spacing[i]) for i in free]

    def at(coordinates: Array) -> Point:
        point = list(starts[0])
        for i, u, coordinate in zip(free, unit, coordinates.tolist(), strict=True):
            moved = u * coordinate if spacing[i] < 0 else math.exp(min(u * coordinate, 700.0))
            point[i] = min(max(moved, bounds[i][0]), bounds[i][1])
        return tuple(point)

    def around(point: Point, edge: float) -> Array:
        begin = [(point[i] if spacing[i] < 0 else math.log(point[i])) / u for i, u in zip(free, unit, strict=True)]
        return np.array(begin) + edge * np.vstack([np.zeros(len(free)), np.eye(len(free))])

    def climb(corners: Array, edge: float, trials: int) -> Array:
        """Return the corners after so many trials, the best first."""
        options = {
            "maxfev": trials,
            "initial_simplex": corners,
            "xatol": _SURE * edge,
            "fatol": _SURE * abs(value(at(corners[0]))),
        }
        found = minimize(lambda x: -value(at(x)), corners[0], method="Nelder-Mead", options=options)
        return np.asarray(found.final_simplex[0])

    def height(corners: Array) -> float:
        return value(at(corners[0]))

    begun = [climb(around(start, _EDGE), _EDGE, _GLANCE) for start in starts[:_STARTS]]
    begun.sort(key=height, reverse=True)
    if height(begun[0]) < _UNLIKELY * worth:
        return first
    begun = [climb(corners, _EDGE, len(corners) + _SHORT) for corners in begun[:_BEST]]
    best = at(max(begun, key=height)[0])
    if value(best) < worth:
        return first
    stalled = 0
    for edge in _EDGES:
        before, best = value(best), at(climb(around(best, edge), edge, _LONG)[0])
        stalled = stalled + 1 if value(best) - before <= _ENOUGH * abs(before) else 0
        if stalled > patience:
            break
    return best


def refine(value: Callable[[Point], float], point: Point, bounds: Sequence[Bounds], spacing: Sequence[float]) -> Point:
    """Return the optimum next to a point by Newton's method, so that it does not depend on the path to the point.

    The derivatives are central differences; a parameter at a bound stays there.

    Args:
        value: what is to be made large.
        point: from a search.
        bounds: of each parameter.
        spacing: as of :func:`multistart_nelder_mead`.
    """
    width = _WIDE
    for _ in range(_NEWTON_STEPS):
        free = [i for i in range(len(point)) if _has_room(point, i, bounds, spacing, width)]
        if not free:
            return point
        step = _newton_step(value, point, spacing, free, width)
        here = value(point)
        for part in _SHORTENED:
            trial = _moved(point, dict(zip(free, (part * step).tolist(), strict=True)), bounds, spacing)
            if value(trial) > here:
                point = trial
                break
        else:
            if width <= _NARROW:
                return point
        longest = float(np.max(np.abs(step)))
        if longest < _CONVERGED:
            return point
        width = min(max(longest, _NARROW), 0.25 * width)
        width = max(width, _NARROW)
    return point


def _has_room(point: Point, i: int, bounds: Sequence[Bounds], spacing: Sequence[float], width: float) -> bool:
    """Whether a parameter can move both ways."""
    if spacing[i] == 1.0 or (spacing[i] > 0 and point[i] <= 0):
        return False
    ends = (_moved(point, {i: side * width}, None, spacing)[i] for side in (-1, 1))
    return all(bounds[i][0] <= end <= bounds[i][1] for end in ends)


def _moved(point: Point, by: Mapping[int, float], bounds: Sequence[Bounds] | None, spacing: Sequence[float]) -> Point:
    """Return a point with some parameters moved by so many spacings, within bounds."""
    moved = list(point)
    for i, distance in by.items():
        step = spacing[i]
        moved[i] = point[i] - step * distance if step < 0 else point[i] * step**distance
        if bounds is not None:
            moved[i] = min(max(moved[i], bounds[i][0]), bounds[i][1])
    return tuple(moved)


def _newton_step(
    value: Callable[[Point], float], point: Point, spacing: Sequence[float], free: Sequence[int], width: float
) -> Array:
    """Return Newton's step in spacings, at most ten times as long as the differences are wide."""

    def at(by: Mapping[int, float]) -> float:
        return value(_moved(point, by, None, spacing))

    here, count = value(point), len(free)
    ahead = np.array([at({i: width}) for i in free])
    behind = np.array([at({i: -width}) for i in free])
    gradient = (ahead - behind) / 2
    curvature = np.diag(ahead + behind - 2 * here)
    for j in range(count):
        for k in range(j):
            both = at({free[j]: width, free[k]: width}) + at({free[j]: -width, free[k]: -width})
            mixed = (both - ahead[j] - ahead[k] - behind[j] - behind[k] + 2 * here) / 2
            curvature[j, k] = curvature[k, j] = mixed
    along, axes = np.linalg.eigh(curvature)
    slope = axes.T @ gradient
    steps = np.divide(slope, np.abs(along), out=np.zeros(count), where=np.abs(along) > 1e-12 * abs(here))
    step = axes @ steps
    longest = float(np.max(np.abs(step)))
    return np.asarray(width * step * min(1.0, 10 / longest if longest > 0 else 1.0))
