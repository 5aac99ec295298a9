r"""How far a parameter may be off by what is left of the rows, where a derivative does not say it.

What a contact does jumps with its parameters, as it opens and closes at samples. The squared error is a stair of many
small steps, and its slope within one of them says nothing of how far the parameter may go. So the likely values are
those that leave hardly more than the estimate,

.. math:: \frac{\nu}{f} \Bigl(\frac{S(p)}{S(\hat p)} - 1\Bigr) \le 1.96^2,

with all other nonlinear parameters as they are and the best linear ones; ν and f as in :mod:`.instants`. Where the
error is smooth they reach no further than 1.96 standard errors. Of more than two nonlinear parameters any may be
another at once, see :func:`likely_points`.

Source: likelihood ratios, as D. M. Bates, D. G. Watts, Nonlinear Regression Analysis (1988), §6.1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from fricmodels.arrays import Array
from fricmodels.weakform.inference import NORMAL_95
from fricmodels.weakform.optimise import Point

_DOUBLINGS, _MISSES, _HALVINGS = 30, 3, 5
"""Steps that double, how many may be unlikely one after the other, and by how many halvings the last one is refined."""
_FURTHEST = 10.0
"""Times the value beyond which nothing is tried."""
_POPULATION, _GENERATIONS, _SAMPLES = 20, 12, 20_000
"""Members of a population, and how often it is renewed where a recording has no more than so many samples."""
_APART, _SPREAD = 1.2, 0.4
"""How far it may go, in logarithms, and its first standard deviation, as a share of that."""
_FEWEST = 4.0
"""Independent equations that a fit rests on at the least. With fewer it would be likely to leave twice the squares, as
a gap of no width does that stands for one in plain sight."""
_LEAST = 1e-6
"""First step, as a share of the value, where there is no standard error."""


def likely_error(
    cost: Callable[[float], float], value: float, error: float, bounds: tuple[float, float], certain: float
) -> float:
    """Return the distance to the furthest likely value either way, over 1.96.

    Args:
        cost: squared error with another value.
        value, error: the estimate and its standard error.
        bounds: of the parameter.
        certain: ν / f.
    """
    most = _most(cost(value), certain)

    def is_likely(step: float) -> bool:
        return bounds[0] <= value + step <= bounds[1] and cost(value + step) <= most

    first = error or _LEAST * abs(value)
    furthest = (_furthest(is_likely, side * first, _FURTHEST * abs(value)) for side in (-1.0, 1.0))
    return max(furthest) / NORMAL_95


def likely_points(
    cost: Callable[[Point], float],
    point: Point,
    bounds: Sequence[tuple[float, float]],
    reach: Sequence[float],
    certain: float,
    samples: int,
) -> list[Point]:
    """Return the outermost of the likely points that a population meets which begins about the estimate.

    With one parameter moved at a time neither what two of them do together is seen, nor another valley.

    Source: R. Storn, K. Price, "Differential evolution", J. Global Optimization 11 (1997); all likely costs are alike.

    Args:
        cost: squared error at a point.
        point: the estimate.
        bounds: of each parameter.
        reach: how far to look: a difference, or 0 for a logarithm by :data:`_APART`, or a negative one for not at all.
        certain: ν / f.
        samples: of the recording; a long one is given fewer generations.
    """
    from scipy.optimize import differential_evolution

    free = [i for i, far in enumerate(reach) if far >= 0.0]
    found, most = [point], _most(cost(point), certain)

    def left(moved: Array) -> float:
        tried = list(point)
        for i, by in zip(free, moved.tolist(), strict=True):
            tried[i] = min(max(point[i] + by if reach[i] else point[i] * math.exp(by), bounds[i][0]), bounds[i][1])
        here = cost(tuple(tried))
        if here <= most:
            found.append(tuple(tried))
        return max(here, most)

    if free:
        far = np.array([reach[i] or _APART for i in free])
        begin = np.clip(_SPREAD * far * np.random.default_rng(0).standard_normal((_POPULATION, len(free))), -far, far)
        begin[0] = 0.0
        generations = max(round(_GENERATIONS * min(1.0, _SAMPLES / samples)), 1)
        sides = list(zip((-far).tolist(), far.tolist(), strict=True))
        differential_evolution(left, sides, init=begin, maxiter=generations, rng=0, polish=False, tol=0.0, atol=-1.0)
    return list({end(found, key=lambda one: one[i]) for i in free for end in (min, max)})


def _most(least: float, certain: float) -> float:
    """Return the squared error up to which a value is likely, of the least squared error."""
    return least * (1.0 + NORMAL_95**2 / max(certain, _FEWEST))


def _furthest(is_likely: Callable[[float], bool], first: float, end: float) -> float:
    """Return the size of the furthest likely step in one direction; 0 where there is none."""
    far, step, missed = 0.0, first, 0
    for _ in range(_DOUBLINGS):
        if abs(step) > end or missed == _MISSES:
            break
        far, missed = (step, 0) if is_likely(step) else (far, missed + 1)
        step *= 2.0
    beyond = 2.0 * far
    for _ in range(_HALVINGS if far else 0):
        middle = 0.5 * (far + beyond)
        far, beyond = (middle, beyond) if is_likely(middle) else (far, middle)
    return abs(far)
