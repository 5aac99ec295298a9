"""CMA-ES: a search without derivatives, for a function with kinks and long valleys."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricmodels import progress
from fricmodels.arrays import Array

_LARGEST = 1e14
"""Ratio of variances in the distribution of steps beyond which it is flat to rounding."""
_SETTLED = 1e-5
"""A generation whose costs lie within this share of the best one, and which found nothing better by more than that, is
the last."""


@dataclass(frozen=True)
class Evolved:
    """The best point that was met, and its cost."""

    at: Array
    cost: float


def evolved(
    cost: Callable[[Array], float],
    start: Array,
    spread: Array,
    bounds: tuple[Array, Array],
    *,
    most: int,
    seed: int = 0,
) -> Evolved:
    r"""Return the best point of a search in which the distribution of steps learns the shape of the valley.

    Each generation draws :math:`x_i = m + \sigma A z_i` with independent normal :math:`z_i`, ranks the draws by
    cost, moves m to a weighted mean of the better half and adapts σ and the covariance :math:`C` of the steps. Ranks
    alone count, so kinks and jumps do no harm. What a draw has beyond a bound is cut off before it is evaluated.

    Args:
        cost: the function; what is not finite is worse than anything.
        start: where the first generation is centred, shape (n,).
        spread: matrix A of the first generation, shape (n, n): a column each for a direction and how far to look.
        bounds: least and greatest value of each.
        most: evaluations.
        seed: of the draws.

    Source: N. Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772, 2016, with its default settings.
    """
    low, high = bounds
    n = len(start)
    random = np.random.default_rng(seed)
    count = 4 + int(3 * math.log(n)) if n > 1 else 6
    parents = count // 2
    weights = math.log((count + 1) / 2) - np.log(np.arange(1, parents + 1))
    weights /= weights.sum()
    effective = 1.0 / float(weights @ weights)
    c_path = (4 + effective / n) / (n + 4 + 2 * effective / n)
    c_sigma = (effective + 2) / (n + effective + 5)
    c_one = 2 / ((n + 1.3) ** 2 + effective)
    c_mu = min(1 - c_one, 2 * (effective - 2 + 1 / effective) / ((n + 2) ** 2 + effective))
    damping = 1 + 2 * max(0.0, math.sqrt((effective - 1) / (n + 1)) - 1) + c_sigma
    expected = math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n**2))

    mean, sigma = np.zeros(n), 1.0  # in columns of the spread
    path, path_sigma, matrix = np.zeros(n), np.zeros(n), np.eye(n)
    values, vectors = np.ones(n), np.eye(n)
    best_at = np.clip(start, low, high)
    best, used, generation = _finite(cost(best_at)), 1, 0
    with progress.steps("trying parameters on the motion", most) as tried:
        while used + count <= most:
            generation += 1
            normal = random.standard_normal((count, n))
            steps = (normal * values) @ vectors.T
            points = np.clip(start + (mean + sigma * steps) @ spread.T, low, high)
            costs = np.array([_finite(cost(point)) for point in points])
            used += count
            tried(count)
            order = np.argsort(costs, kind="stable")
            before = best
            if costs[order[0]] < best:
                best, best_at = float(costs[order[0]]), points[order[0]]
            chosen = steps[order[:parents]]
            moved = weights @ chosen
            mean = mean + sigma * moved
            path_sigma = (1 - c_sigma) * path_sigma + math.sqrt(c_sigma * (2 - c_sigma) * effective) * (
                vectors @ ((vectors.T @ moved) / values)
            )
            length = float(np.linalg.norm(path_sigma))
            steady = length / math.sqrt(1 - (1 - c_sigma) ** (2 * generation)) < (1.4 + 2 / (n + 1)) * expected
            path = (1 - c_path) * path + (math.sqrt(c_path * (2 - c_path) * effective) * moved if steady else 0.0)
            kept = 0.0 if steady else c_path * (2 - c_path)
            matrix = (
                (1 - c_one * (1 - kept) - c_mu) * matrix
                + c_one * np.outer(path, path)
                + c_mu * (chosen.T * weights) @ chosen
            )
            sigma *= math.exp(min(1.0, c_sigma / damping * (length / expected - 1)))
            squares, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
            if not squares[-1] > 0:
                break
            values = np.sqrt(np.maximum(squares, squares[-1] / _LARGEST))
            around = costs[order[: parents + 1]]
            if math.isfinite(best) and before - best <= _SETTLED * best and around[-1] - around[0] <= _SETTLED * best:
                break
    return Evolved(best_at, best)


def _finite(cost: float) -> float:
    return cost if math.isfinite(cost) else math.inf
