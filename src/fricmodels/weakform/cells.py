"""Loops over the cells of a recording, compiled: one pass in place of twenty over arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

_BLOCK, _AT_ONCE = 512, 16
"""Test functions that are summed together, and how many at once."""


@njit(cache=True, nogil=True)
def along_cubics(rows: Any, half: Any, cell: Any, before: Any, after: Any, bending: Any, values: Any) -> None:
    """Write the integral of each row over each cell; see :meth:`.quadrature.Quadrature.sums_along_cubics`.

    Args:
        rows: at the samples and at the instants of stopping and of starting, shape (k, N + 2 c).
        half: half the duration of each cell, shape (N − 1,).
        cell, before, after: split cells, and half the duration of motion before and after the zero, shape (c,).
        bending: weights of the changes in the cell before, each cell and the cell after, shape (3, N − 3).
        values: to be written, shape (k, N).
    """
    count, cells = len(half) + 1, len(cell)
    earlier, same, later = bending[0], bending[1], bending[2]
    for i in range(len(rows)):
        row, value = rows[i], values[i]
        value[count - 1] = 0.0
        for k in range(min(count - 1, 1)):
            value[k] = (row[k] + row[k + 1]) * half[k]
        for k in range(1, count - 2):
            own = same[k - 1] * (row[k + 1] - row[k])
            bend = later[k - 1] * (row[k + 2] - row[k + 1]) + earlier[k - 1] * (row[k] - row[k - 1]) + own
            value[k] = (row[k] + row[k + 1]) * half[k] + bend
        for k in range(max(count - 2, 1), count - 1):
            value[k] = (row[k] + row[k + 1]) * half[k]
        for j in range(cells):
            k = cell[j]
            stopping, starting = row[count + j], row[count + cells + j]
            value[k] = before[j] * (row[k] + stopping) + after[j] * (starting + row[k + 1])


@njit(cache=True, nogil=True)
def under_hats(
    rows: Any, half: Any, cell: Any, before: Any, after: Any, half_step: Any, bending: Any, values: Any
) -> None:
    """Write the integral of each row under hats; see :meth:`.quadrature.Quadrature.under_hats`.

    Args:
        rows, half, cell, before, after, bending, values: as of :func:`along_cubics`.
        half_step: half the duration of each split cell, shape (c,).
    """
    count, cells, late = len(half) + 1, len(cell), np.empty(len(half))
    earlier, same, later = bending[0], bending[1], bending[2]
    for i in range(len(rows)):
        row, value = rows[i], values[i]
        for k in range(1, count - 2):
            own = same[k - 1] * (row[k + 1] - row[k])
            bend = later[k - 1] * (row[k + 2] - row[k + 1]) + earlier[k - 1] * (row[k] - row[k - 1]) + own
            whole = (row[k] + row[k + 1]) * half[k] + bend
            late[k] = half[k] / 3.0 * (row[k] + 2.0 * row[k + 1]) + 0.5 * bend
            value[k] = whole - late[k]
        for k in (0, count - 2):
            if 0 <= k < len(half):
                late[k] = half[k] / 3.0 * (row[k] + 2.0 * row[k + 1])
                value[k] = (row[k] + row[k + 1]) * half[k] - late[k]
        for j in range(cells):  # where a cell is split it has no cubic
            k = cell[j]
            stopping, starting = row[count + j], row[count + cells + j]
            moving_on = after[j] * (starting + row[k + 1])
            whole = before[j] * (row[k] + stopping) + moving_on
            late[k] = 0.0
            if half_step[j] > 0.0:
                rising = before[j] ** 2 / half_step[j] * (row[k] + 2.0 * stopping)
                falling = after[j] ** 2 / half_step[j] * (2.0 * starting + row[k + 1])
                late[k] = rising / 3.0 + moving_on - falling / 3.0
            value[k] = whole - late[k]
        value[count - 1] = 0.0
        for k in range(count - 1):
            value[k + 1] += late[k]


@njit(cache=True, nogil=True)
def runs_of(kept: Any, first: Any, counts: Any, hop: int, begins: Any, lengths: Any) -> int:
    """Write where each run of neighbouring test functions begins, and how many there are in it; return how many runs.

    Args:
        kept: which of all test functions are wanted, ascending, shape (M,).
        first: sample at which the first test function of each stretch begins, shape (s,).
        counts: how many test functions there are in each stretch, a part of a test function apart, shape (s,).
        hop: samples from test function to test function.
        begins, lengths: to be written as far as there are runs, shape (M,).
    """
    found, piece, before = 0, 0, 0
    for m in range(len(kept)):
        new = m == 0 or kept[m] != kept[m - 1] + 1
        while kept[m] >= before + counts[piece]:
            before += counts[piece]
            piece, new = piece + 1, True
        if new:
            begins[found], lengths[found] = first[piece] + hop * (kept[m] - before), 0
            found += 1
        lengths[found - 1] += 1
    return found


@njit(cache=True, nogil=True)
def side_by_side(values: Any, hop: int, count: int, places: Any) -> None:
    """Write every hop-th of some values side by side, shape (count · hop,) → (hop, count or more).

    A distance that is known when this is compiled is read many values at once.
    """
    if hop == 2:
        one, two = places[0], places[1]
        for m in range(count):
            one[m], two[m] = values[2 * m], values[2 * m + 1]
    elif hop == 4:
        one, two, three, four = places[0], places[1], places[2], places[3]
        for m in range(count):
            one[m], two[m] = values[4 * m], values[4 * m + 1]
            three[m], four[m] = values[4 * m + 2], values[4 * m + 3]
    else:
        for j in range(hop):
            place = places[j]
            for m in range(count):
                place[m] = values[hop * m + j]


@njit(cache=True, nogil=True)
def weighted_sums(rows: Any, begins: Any, lengths: Any, parts: Any, sums: Any) -> None:
    """Write the sums of each row under a test function that is moved along it, in the same order on every processor.

    A test function is made of as many equal parts as there are hops to it. Samples at the same place in a part are put
    side by side: those of all test functions then are. These are taken in blocks that stay in the cache; a block is
    filled up, so that none of it is left over when many are summed at once.

    Args:
        rows: shape (k, N).
        begins: sample at which the first test function of each run begins, shape (s,).
        lengths: how many test functions there are in each run, a part of a test function apart, shape (s,).
        parts: weights of a test function, shape (8, hop).
        sums: to be written, shape (k, M).
    """
    hop = parts.shape[1]
    places, found = np.zeros((hop, _BLOCK + _AT_ONCE + 7)), np.empty(_BLOCK + _AT_ONCE)
    for i in range(len(rows)):
        row, done = rows[i], 0
        for run in range(len(begins)):
            for before in range(0, lengths[run], _BLOCK):
                n, start = min(lengths[run] - before, _BLOCK), begins[run] + before * hop
                side_by_side(row[start : start + (n + 7) * hop], hop, n + 7, places)
                filled = (n + _AT_ONCE - 1) // _AT_ONCE * _AT_ONCE
                for m in range(filled):
                    found[m] = 0.0
                for j in range(hop):
                    t = places[j]
                    a, b, c, d = parts[0, j], parts[1, j], parts[2, j], parts[3, j]
                    e, f, g, h = parts[4, j], parts[5, j], parts[6, j], parts[7, j]
                    for m in range(filled):
                        one = (a * t[m] + b * t[m + 1]) + (c * t[m + 2] + d * t[m + 3])
                        other = (e * t[m + 4] + f * t[m + 5]) + (g * t[m + 6] + h * t[m + 7])
                        found[m] += one + other
                sums[i, done : done + n] = found[:n]
                done += n


@njit(cache=True, nogil=True)
def sums_along_cubics(
    rows: Any,
    half: Any,
    cell: Any,
    before: Any,
    after: Any,
    bending: Any,
    begins: Any,
    lengths: Any,
    parts: Any,
    sums: Any,
) -> None:
    """Write the sums under test functions of the integral of each row over each cell, one row after the other.

    Args:
        rows, half, cell, before, after, bending: as of :func:`along_cubics`.
        begins, lengths, parts, sums: as of :func:`weighted_sums`.
    """
    values = np.empty((1, len(half) + 1))
    for i in range(len(rows)):
        along_cubics(rows[i : i + 1], half, cell, before, after, bending, values)
        weighted_sums(values, begins, lengths, parts, sums[i : i + 1])
