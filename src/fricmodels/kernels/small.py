"""Small symmetric matrices, compiled: for these a call of LAPACK is mostly overhead. And what NumPy has no call for."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def lower_factor(matrix: Any) -> float:
    """Replace a positive matrix of unit diagonal by its Cholesky factor; return its determinant, 0 if it has none."""
    count, product = len(matrix), 1.0
    for j in range(count):
        for i in range(j, count):
            left = matrix[i, j]
            for k in range(j):
                left -= matrix[i, k] * matrix[j, k]
            if i == j:
                if not left > 0.0:
                    return 0.0
                product *= left
                matrix[j, j] = np.sqrt(left)
            else:
                matrix[i, j] = left / matrix[j, j]
    return product


@njit(cache=True, nogil=True)
def invert(gram: Any, least: float, size: Any, inverse: Any) -> float:
    """Write the lengths of columns and the inverse of their products; return the determinant of the scaled products.

    Args:
        gram: products of the columns, shape (n, n).
        least: square of a column that is zero; its length is 1.
        size: to be written, shape (n,).
        inverse: to be written, shape (n, n), where the determinant is not zero.
    """
    count = len(gram)
    factor = np.empty((count, count))
    for i in range(count):
        size[i] = np.sqrt(gram[i, i]) if gram[i, i] > least else 1.0
    for i in range(count):
        for j in range(count):
            factor[i, j] = gram[i, j] / (size[i] * size[j])
    determinant = lower_factor(factor)
    if determinant > 0.0:
        for j in range(count):  # the inverse of the factor, in place
            factor[j, j] = 1.0 / factor[j, j]
            for i in range(j + 1, count):
                total = 0.0
                for k in range(j, i):
                    total -= factor[i, k] * factor[k, j]
                factor[i, j] = total / factor[i, i]
        for i in range(count):
            for j in range(i + 1):
                total = 0.0
                for k in range(i, count):
                    total += factor[k, i] * factor[k, j]
                inverse[i, j] = inverse[j, i] = total / (size[i] * size[j])
    return determinant


@njit(cache=True, nogil=True)
def first_alone(gram: Any, least: float, certain: float) -> float:
    """Return what the first column has that the others do not explain, squared; 0 where that is not certain.

    Args:
        gram, least: as of :func:`invert`.
        certain: determinant above which it is.
    """
    size, inverse = np.empty(len(gram)), np.empty(gram.shape)
    return 1.0 / inverse[0, 0] if invert(gram, least, size, inverse) > certain else 0.0


@njit(cache=True, nogil=True)
def reduced(
    gram: Any, right: Any, inner: Any, free: Any, last: Any, scale: Any, damping: float, matrix: Any, gradient: Any
) -> None:
    """Write what is left of the last columns' normal equations when the free ones follow.

    Args:
        gram, right: of all columns, shapes (n, n) and (n,).
        inner: inverse of the products of the free columns, shape (f, f).
        free, last: which columns these are.
        scale: by which the last columns are multiplied, shape (m,).
        damping: share of the diagonal of the matrix that is added to it.
        matrix, gradient: to be written, shapes (m, m) and (m,).
    """
    for a in range(len(last)):
        p = last[a]
        along = np.zeros(len(free))
        for i in range(len(free)):
            for j in range(len(free)):
                along[i] += inner[i, j] * gram[free[j], p]
        found = right[p]
        for i in range(len(free)):
            found -= along[i] * right[free[i]]
        gradient[a] = found * scale[a]
        for b in range(len(last)):
            q = last[b]
            found = gram[q, p]
            for i in range(len(free)):
                found -= along[i] * gram[free[i], q]
            matrix[a, b] = found * scale[a] * scale[b]
        matrix[a, a] += damping * max(matrix[a, a], 1e-300)


@njit(cache=True, nogil=True, fastmath={"reassoc"})
def product(one: Any, other: Any) -> float:
    """Return the sum of products, in any order."""
    total = 0.0
    for k in range(len(one)):
        total += one[k] * other[k]
    return total


@njit(cache=True, nogil=True)
def products_of_blocks(rows: Any, residual: Any, edges: Any, shares: Any, scores: Any) -> None:
    """Write the products of rows with each other and with a residual, block by block.

    Args:
        rows: shape (n, M). residual: shape (M,).
        edges: where each block begins, and where the last one ends, shape (blocks + 1,).
        shares, scores: to be written, shapes (blocks, n, n) and (blocks, n).
    """
    for g in range(len(edges) - 1):
        begin, end = edges[g], edges[g + 1]
        for i in range(len(rows)):
            row = rows[i, begin:end]
            scores[g, i] = product(row, residual[begin:end])
            for j in range(i + 1):
                shares[g, i, j] = shares[g, j, i] = product(row, rows[j, begin:end])


@njit(cache=True, nogil=True)
def visible(gram: Any, power: Any, seen: float, asked: Any, factor: Any, kept: Any) -> int:
    """Write which of some columns can be told from those before them, and their Cholesky factor; return how many.

    Args:
        gram: products of the columns freed of others, shape (n, n). power: of each before it was freed, shape (n,).
        seen: share of its power of which a column must keep more.
        asked: whether a column is considered, shape (n,).
        factor: to be written, lower triangular, shape (n, n). kept: to be written, the columns in order, shape (n,).
    """
    count = 0
    for i in range(len(power)):
        if not (asked[i] and 0.0 < power[i] < np.inf):
            continue
        left = gram[i, i]
        for a in range(count):
            part = gram[i, kept[a]]
            for b in range(a):
                part -= factor[a, b] * factor[count, b]
            factor[count, a] = part / factor[a, a]
            left -= factor[count, a] ** 2
        if left > seen * power[i]:
            factor[count, count] = np.sqrt(left)
            kept[count] = i
            count += 1
    return count


@njit(cache=True, nogil=True)
def explained_within(
    gram: Any, power: Any, seen: float, right: Any, lower: Any, upper: Any, asked: Any, theta: Any
) -> float:
    """Write least-squares coefficients, and return the explained sum of squares.

    A column whose coefficient would pass its bounds is left out, and those that are left are taken anew.

    Args:
        gram, power, seen, asked: as of :func:`visible`; a column that is left out is not asked for any more.
        right: products with the target, shape (n,).
        lower, upper: bounds of the coefficients, shape (n,).
        theta: to be written, zeros, shape (n,).
    """
    count = len(power)
    factor, kept, along = np.empty((count, count)), np.empty(count, np.int64), np.empty(count)
    while True:
        there = visible(gram, power, seen, asked, factor, kept)
        if there == 0:
            return 0.0
        gained = 0.0
        for a in range(there):
            part = right[kept[a]]
            for b in range(a):
                part -= factor[a, b] * along[b]
            along[a] = part / factor[a, a]
            gained += along[a] ** 2
        for a in range(there - 1, -1, -1):
            for b in range(a + 1, there):
                along[a] -= factor[b, a] * along[b]
            along[a] /= factor[a, a]
        within = True
        for i in range(count):
            asked[i] = False
        for a in range(there):
            i = kept[a]
            asked[i] = not (along[a] < lower[i] or along[a] > upper[i])
            within = within and asked[i]
        if within:
            for a in range(there):
                theta[kept[a]] = along[a]
            return gained


_TURNS_EXACT = 1e6
"""Angle [rad] up to which its quarter turns times the first part of π/2 are exact."""
_WHOLE = 1.5 * 2.0**52
"""A sum with it has no digits after the point."""


@njit(cache=True, nogil=True)
def sine_and_cosine(angle: Any, both: Any) -> None:
    """Write sine and cosine of each angle, shape (N,) → (2, N), to two units of the last digit.

    The nearest quarter turn is taken off in three parts of π/2, the first two with so few digits that their products
    are exact; what is left, within ±π/4, goes into two polynomials. There is no branch, so that several angles are done
    at once. Larger angles, and what is no number, go through the library.

    Source: constants of K. C. Ng, ``__ieee754_rem_pio2``, ``__kernel_sin`` and ``__kernel_cos``, fdlibm, Sun (1993).
    """
    within = 0
    for i in range(len(angle)):
        within += abs(angle[i]) < _TURNS_EXACT
    if within < len(angle):
        for i in range(len(angle)):
            both[0, i] = sin(angle[i])
            both[1, i] = cos(angle[i])
        return
    for i in range(len(angle)):
        quarters = (angle[i] * 0.6366197723675814 + _WHOLE) - _WHOLE
        x = angle[i] - quarters * 1.57079632673412561417
        x = (x - quarters * 6.07710050630396597660e-11) - quarters * 2.02226624879595063154e-21
        z = x * x
        s = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10
        s = -1.98412698298579493134e-04 + z * (2.75573137070700676789e-06 + z * s)
        s = x + x * z * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * s))
        c = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
        c = 4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * c))
        c = 1.0 - (0.5 * z - z * z * c)
        turned = quarters - 4.0 * np.floor(0.25 * quarters)
        odd = turned == 1.0 or turned == 3.0
        sine, cosine = c if odd else s, s if odd else c
        both[0, i] = -sine if turned >= 2.0 else sine
        both[1, i] = -cosine if turned == 1.0 or turned == 2.0 else cosine
