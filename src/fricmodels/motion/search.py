"""Finds the least error of a simulated motion: by derivatives, and where these end in a kink, without them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from fricmodels.arrays import Array
from fricmodels.motion.evolution import evolved
from fricmodels.motion.least_squares import STEP, jacobian, minimised

Loss: TypeAlias = Literal["squares", "absolute"]
Residual: TypeAlias = Callable[[Array], Array]

COARSE = 3e-2
"""Of a difference that looks over a kink, in sizes of a parameter."""
NEARLY = 1e-2
"""Share of the median absolute error below which an absolute error is squared, so that it has a derivative."""
_RISES = (3.0, 0.3, 0.03)
"""By which share of itself the cost would rise at the edge of what a round looks at, if it were a bowl."""
_EVALUATIONS = 40
"""Of a round, for each parameter."""
_ROUNDS, _GAIN = 8, 0.01
"""Most rounds; one that gains less than this share of the cost is the last of its kind."""
_WIDEST = 0.5
"""Greatest distance that a round looks, in values of a parameter (or ten of its sizes, if that is more)."""


@dataclass(frozen=True)
class Found:
    """Where a search ended: parameters, cost by the loss, evaluations, and whether it ended by itself."""

    at: Array
    cost: float
    evaluations: int
    converged: bool


def cost_of(residual: Array, loss: Loss) -> float:
    """Return the sum of squares, or of absolute values; infinite where it is no number."""
    with np.errstate(over="ignore", invalid="ignore"):
        cost = float(np.sum(np.abs(residual))) if loss == "absolute" else float(residual @ residual)
    return cost if math.isfinite(cost) else math.inf


def absolute(residual: Array) -> Array:
    """Return the weights with which squares are absolute errors, squares again where an error is nearly zero."""
    size = np.abs(residual)
    least = NEARLY * float(np.median(size)) or 1.0
    return np.asarray(1.0 / np.maximum(size, least))


def searched(
    residual: Residual,
    starts: Sequence[Array],
    size: Array,
    bounds: tuple[Array, Array],
    *,
    loss: Loss = "squares",
    most: int = 60,
    kinks: bool = True,
) -> Found:
    r"""Return the best of all ends.

    1. Levenberg–Marquardt from each start, first with long differences that look over the kinks where a drive stops or
       starts, then with short ones.
    2. Around the best end, unless it lies in a bowl, rounds of CMA-ES: within what would raise the cost by three times
       itself as long as a round gains a hundredth, then by three tenths, then by three hundredths. The first steps have
       the shape of the valley, from the long differences. What a round ends in goes through short differences again.

    A bowl is where the cost at both ends of each axis of the valley, of all three lengths, rises by at least half of
    what the derivatives say: there is no kink to be stuck in.

    Args:
        residual: of shape (N,). starts: each of shape (n,). size: of each parameter. bounds: least and greatest.
        loss: what is summed. most: Jacobians, for each start.
        kinks: whether to take the second step.
    """
    weights = absolute if loss == "absolute" else None
    count = 0

    def evaluated(x: Array) -> Array:
        nonlocal count
        count += 1
        return residual(x)

    def cost(x: Array) -> float:
        return cost_of(evaluated(x), loss)

    def descended(begin: Array, lengths: Sequence[float]) -> Found:
        at, best = begin, Found(begin, cost(begin), 0, False)
        for length in lengths:
            end = minimised(evaluated, at, size, bounds, most=most, weights=weights, relative_step=length)
            at = end.at
            here = cost(at)
            if here < best.cost or (here == best.cost and end.converged):
                best = Found(at, here, 0, end.converged)
        return best

    best = min((descended(np.clip(start, *bounds), (COARSE, STEP)) for start in starts), key=lambda end: end.cost)
    rises = list(_RISES) if kinks else []
    for number in range(_ROUNDS):
        if not rises or not math.isfinite(best.cost) or best.cost == 0.0:
            break
        axes, risen = valley(evaluated, best.at, size, bounds, rises[0] * best.cost, loss)
        if number == 0 and _is_bowl(cost, best, axes, risen, bounds):
            break
        before = best.cost
        further = evolved(cost, best.at, axes, bounds, most=_EVALUATIONS * len(size), seed=number)
        if further.cost < best.cost:
            best = Found(further.at, further.cost, 0, best.converged)
            ended = descended(best.at, (STEP,))
            best = ended if ended.cost < best.cost else best
        if best.cost > (1 - _GAIN) * before:
            rises.pop(0)
    return Found(best.at, best.cost, count, best.converged)


def valley(
    residual: Residual, at: Array, size: Array, bounds: tuple[Array, Array], rise: float, loss: Loss = "squares"
) -> tuple[Array, Array]:
    r"""Return the axes of the valley about a point, a column each, as long as the cost rises by so much on them.

    Beside them, the share of that rise which the derivatives say for the end of each: less than 1 where the greatest
    distance is what ends it.

    With the normal matrix :math:`N = J^TWJ/\text{rise}` of long differences and :math:`\Lambda` for the greatest
    distances, the axes are those of :math:`(N + \Lambda^{-2})^{-1}`.
    """
    here = residual(at)
    slope = np.nan_to_num(
        jacobian(residual, at, here, COARSE * np.maximum(np.abs(at), size), bounds, central=True), posinf=0, neginf=0
    )
    weight = absolute(here) if loss == "absolute" else np.ones(len(here))
    alone = slope.T @ (slope * weight[:, None]) / rise
    widest = _WIDEST * np.maximum(np.abs(at), 10 * size)
    normal = alone + np.diag(widest**-2.0)
    scale = 1 / np.sqrt(np.diag(normal))
    values, vectors = np.linalg.eigh(normal * np.outer(scale, scale))
    axes = scale[:, None] * vectors / np.sqrt(np.maximum(values, 1e-12))
    return axes, np.asarray(np.sum(axes * (alone @ axes), axis=0))


def _is_bowl(
    cost: Callable[[Array], float], best: Found, axes: Array, risen: Array, bounds: tuple[Array, Array]
) -> bool:
    """Say whether the cost rises along each axis as the derivatives say, far from the end and near to it."""
    if not best.converged:
        return False
    for rise in _RISES:
        for axis, said in zip(axes.T * math.sqrt(rise / _RISES[0]), risen, strict=True):
            for sign in (1, -1):
                there = np.clip(best.at + sign * axis, *bounds)
                share = float(np.linalg.norm(there - best.at) / max(float(np.linalg.norm(axis)), 1e-300))
                if cost(there) < best.cost * (1 + rise * said * share**2 / 2):
                    return False
    return True
