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
def sine_and_cosine(angle: Any, both: Any) -> None:
    """Write sine and cosine of each angle, shape (N,) → (2, N)."""
    for i in range(len(angle)):
        both[0, i] = sin(angle[i])
        both[1, i] = cos(angle[i])
