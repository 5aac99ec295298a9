"""Loops over the cells of a motion, compiled: which are split, and how a torque bends within them."""

from __future__ import annotations

from typing import Any

from numba import njit

_EQUAL = 1e-3
"""Share by which two speeds of a coarse sensor may differ in their last digits, and are one."""


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
        half: half the duration of each cell, 0 where it is missing, shape (N − 1,).
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


@njit(cache=True, nogil=True)
def where_whole(half: Any, weights: Any, kept: Any) -> None:
    """Write weights where the cell and both of its neighbours are whole, 0 elsewhere.

    Args:
        half: half the duration of each cell, 0 where it is split, rests or is missing, shape (N − 1,).
        weights: of :func:`bending_of`, shape (3, N − 3).
        kept: to be written, shape (3, N − 3).
    """
    for k in range(weights.shape[1]):
        whole = half[k] > 0.0 and half[k + 1] > 0.0 and half[k + 2] > 0.0
        for i in range(3):
            kept[i, k] = weights[i, k] if whole else 0.0


@njit(cache=True, nogil=True)
def bent_about(cells: Any, half: Any, split: Any, weights: Any, change: Any, bent: Any) -> None:
    """Write what a cubic adds in some cells and beside them that is left out where these are split.

    Args:
        cells: which cells, shape (c,).
        half: half the duration of each cell, these cells counted as whole, shape (N − 1,).
        split: the same with these cells as split.
        weights: of :func:`bending_of`, shape (3, N − 3).
        change: of the torque in each cell, shape (N − 1,).
        bent: to be written there, shape (N,).
    """
    for cell in cells:
        for k in range(max(cell - 2, 0), min(cell + 1, weights.shape[1])):
            whole = half[k] > 0.0 and half[k + 1] > 0.0 and half[k + 2] > 0.0
            if whole and not (split[k] > 0.0 and split[k + 1] > 0.0 and split[k + 2] > 0.0):
                bent[k + 1] = weights[0, k] * change[k] + weights[1, k] * change[k + 1] + weights[2, k] * change[k + 2]


@njit(cache=True, nogil=True)
def hidden_turns(velocity: Any, run: Any, band: float, push: Any, least: Any, most: Any, marked: Any) -> None:
    """Mark both ends of each cell in which a drive may have turned unseen; see :mod:`.unclear`.

    Args:
        velocity, run: at the samples, shape (N,).
        band: velocity up to which it may be zero.
        push: torque that drives, shape (N,).
        least, most: friction torques between which the drive may stick, shape (N,).
        marked: to be written, shape (N,).
    """
    marked[:] = False
    for k in range(len(velocity) - 1):
        first, last = abs(velocity[k]), abs(velocity[k + 1])
        # A velocity on a grid often changes by exactly what it is: its last digits must not decide.
        near = (1.0 - _EQUAL) * min(first, last) < abs(velocity[k + 1] - velocity[k]) or max(first, last) <= band
        if near and run[k] == run[k + 1]:
            forward = push[k] > most[k] and push[k + 1] > most[k + 1]
            back = push[k] < least[k] and push[k + 1] < least[k + 1]
            if not (forward or back):
                marked[k] = marked[k + 1] = True
