"""Integrals over the cells of a recording, compiled: one pass over the samples in place of twenty over arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def along_cubics(rows: Any, half: Any, cell: Any, before: Any, after: Any, bending: Any, values: Any) -> None:
    """Write the integral of each row over each cell; see :meth:`.test_functions.Quadrature.along_cubics`.

    Args:
        rows: at the samples and at the instants of stopping and of starting, shape (k, N + 2 c).
        half: half the duration of each cell, shape (N − 1,).
        cell, before, after: split cells, and half the duration of motion before and after the zero, shape (c,).
        bending: weights of the changes in the cell before, each cell and the cell after, shape (3, N − 3).
        values: to be written, shape (k, N).
    """
    count, cells = len(half) + 1, len(cell)
    for i in range(len(rows)):
        row, value = rows[i], values[i]
        for k in range(count - 1):
            value[k] = (row[k] + row[k + 1]) * half[k]
        value[count - 1] = 0.0
        for j in range(cells):
            k = cell[j]
            stopping, starting = row[count + j], row[count + cells + j]
            value[k] = before[j] * (row[k] + stopping) + after[j] * (starting + row[k + 1])
        _bend(row, bending, value, count)


@njit(cache=True, nogil=True)
def _bend(row: Any, bending: Any, value: Any, count: int) -> None:
    """Add what a cubic differs by from the straight line over each cell but the first and last."""
    for k in range(1, count - 2):
        own = bending[1, k - 1] * (row[k + 1] - row[k])
        value[k] += bending[2, k - 1] * (row[k + 2] - row[k + 1]) + bending[0, k - 1] * (row[k] - row[k - 1]) + own


@njit(cache=True, nogil=True)
def under_hats(
    rows: Any, half: Any, cell: Any, before: Any, after: Any, half_step: Any, bending: Any, values: Any
) -> None:
    """Write the integral of each row under hats; see :meth:`.test_functions.Quadrature.under_hats`.

    Args:
        rows, half, cell, before, after, bending, values: as of :func:`along_cubics`.
        half_step: half the duration of each split cell, shape (c,).
    """
    count, cells = len(half) + 1, len(cell)
    whole, late = np.empty(count), np.empty(count)
    for i in range(len(rows)):
        row, value = rows[i], values[i]
        for k in range(count - 1):
            whole[k] = (row[k] + row[k + 1]) * half[k]
            late[k] = half[k] / 3.0 * (row[k] + 2.0 * row[k + 1])
        for j in range(cells):
            k = cell[j]
            stopping, starting = row[count + j], row[count + cells + j]
            moving_on = after[j] * (starting + row[k + 1])
            whole[k] = before[j] * (row[k] + stopping) + moving_on
            late[k] = 0.0
            if half_step[j] > 0.0:
                rising = before[j] ** 2 / half_step[j] * (row[k] + 2.0 * stopping)
                falling = after[j] ** 2 / half_step[j] * (2.0 * starting + row[k + 1])
                late[k] = rising / 3.0 + moving_on - falling / 3.0
        for k in range(1, count - 2):
            own = bending[1, k - 1] * (row[k + 1] - row[k])
            bend = bending[2, k - 1] * (row[k + 2] - row[k + 1]) + bending[0, k - 1] * (row[k] - row[k - 1]) + own
            whole[k] += bend
            late[k] += 0.5 * bend
        value[count - 1] = 0.0
        for k in range(count - 1):
            value[k] = whole[k] - late[k]
        for k in range(count - 1):
            value[k + 1] += late[k]
