"""Loops over the cells of a motion, compiled: which are split, and how a torque bends within them."""

from __future__ import annotations

from typing import Any

from numba import njit


@njit(cache=True, nogil=True)
def split_cells(step: Any, joined: Any, velocity: Any, resting: Any, half: Any, cell: Any) -> int:
    """Write half the duration of each cell that is not split, 0 for the others, and the split ones; return how many.

    Args:
        step: duration of each cell, shape (N − 1,). joined: whether there is no gap within it.
        velocity, resting: at the samples, shape (N,).
        half: to be written, shape (N − 1,).
        cell: to be written as far as there are split ones, shape (N − 1,).
    """
    found = 0
    for k in range(len(step)):
        both = not resting[k] and not resting[k + 1]
        turning = both and velocity[k] * velocity[k + 1] <= 0.0
        half[k] = 0.5 * step[k] if both and not turning else 0.0
        if joined[k] and (turning or resting[k] != resting[k + 1]):
            cell[found] = k
            found += 1
    return found


@njit(cache=True, nogil=True)
def bending_of(half: Any, weights: Any) -> None:
    """Write the weights of the changes within the cell before, each cell, and the cell after.

    Args:
        half: half the duration of each cell, 0 where it is split, rests or is missing, shape (N − 1,).
        weights: to be written, shape (3, N − 3).
    """
    most, largest = 0.0, 0.0
    for k in range(weights.shape[1]):
        before, own, after = 2.0 * half[k], 2.0 * half[k + 1], 2.0 * half[k + 2]
        weights[0, k] = weights[1, k] = weights[2, k] = 0.0
        if before > 0.0 and own > 0.0 and after > 0.0:
            cube = -(own**3) / 24.0
            first, last = 2.0 / (before + own), 2.0 / (own + after)
            weights[0, k] = -cube * first / before
            weights[1, k] = cube * (first - last) / own
            weights[2, k] = cube * last / after
            most, largest = max(most, abs(weights[1, k])), max(largest, abs(weights[2, k]))
    if not most > 1e-6 * largest:
        weights[1, :] = 0.0
