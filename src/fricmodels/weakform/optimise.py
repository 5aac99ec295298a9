"""Climbs to the summit of a function of a few physical parameters, which may lie on a long and narrow ridge."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float, ...]
Bounds = tuple[float, float]

_ROUNDS = 7
_LONGEST_WALK = 12
_STARTS, _GLANCE = 12, 12
"""So many simplexes are begun, with so many trials each."""
_BEST, _SHORT = 8, 28
"""So many of them have so many more."""
_UNLIKELY = 0.25
"""Where none has come to this share of what is worth it by then, none will."""
_LONG, _ENOUGH = 150, 0.003
"""The best one has so many more, and is begun anew as long as that raises the value by this share."""
_EDGE, _EDGES = 0.5, (0.25, 0.5) * 4
"""Edges of a simplex at first and whenever it is begun anew, in spacings of what was tried before."""
_SURE = 1e-4
"""A simplex has arrived when its corners differ by this share of the value and of an edge."""


def coordinate_search(
    value: Callable[[Point], float], point: Point, bounds: Sequence[Bounds], spacing: Sequence[float]
) -> Point:
    """Climb from a point, each parameter in turn, by steps that halve each round, and then along what a round moved.

    Args:
        value: what is to be made large.
        point: where to begin.
        bounds: of each parameter.
        spacing: first step of each parameter: a ratio if positive, a difference if negative.
    """
    steps = list(spacing)
    best = value(point)
    for _ in range(_ROUNDS):
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
        steps = [step / 2 if step < 0 else step**0.5 for step in steps]
    return point


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
            best one does not reach it, it ends early.
        patience: how many more times it is begun anew where that did not raise the value.
    """
    from scipy.optimize import minimize

    free = [i for i, step in enumerate(spacing) if step != 1.0]
    if not free:
        return max(starts, key=value)
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
    if height(begun[0]) >= _UNLIKELY * worth:
        begun = [climb(corners, _EDGE, len(corners) + _SHORT) for corners in begun[:_BEST]]
    best = at(max(begun, key=height)[0])
    stalled = 0
    for edge in _EDGES if value(best) >= worth else ():
        before, best = value(best), at(climb(around(best, edge), edge, _LONG)[0])
        stalled = stalled + 1 if value(best) - before <= _ENOUGH * abs(before) else 0
        if stalled > patience:
            break
    return best
