"""A covariance as a filter keeps it: the lower triangle, so that it stays symmetric."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmodels.arrays import Array


def pack(matrix: Array) -> Array:
    """Return the lower triangle, row by row."""
    return np.asarray(matrix[np.tril_indices(len(matrix))])


def unpack(triangle: Array, order: int) -> Array:
    """Return the symmetric matrix of a lower triangle."""
    matrix = np.zeros((order, order))
    matrix[np.tril_indices(order)] = triangle
    return np.asarray(matrix + np.tril(matrix, -1).T)


def symbolic_covariance(order: int) -> tuple[Any, Any]:
    """Return the packed column of symbols and the symmetric ``SX`` matrix of a covariance."""
    import casadi

    triangle = casadi.SX.sym("P", order * (order + 1) // 2)
    matrix = casadi.SX(order, order)
    for k, (i, j) in enumerate(zip(*np.tril_indices(order), strict=True)):
        matrix[int(i), int(j)] = triangle[k]
        matrix[int(j), int(i)] = triangle[k]
    return triangle, matrix


def symbolic_pack(matrix: Any) -> Any:
    """Return the lower triangle of an ``SX`` matrix, row by row: symmetry is kept because half is stored."""
    import casadi

    rows, columns = np.tril_indices(matrix.shape[0])
    return casadi.vertcat(*(matrix[int(i), int(j)] for i, j in zip(rows, columns, strict=True)))


def symbolic_prediction(jacobian: Any, covariance: Any, added: Any) -> Any:
    """Return F P Fᵀ plus a diagonal; elements mirrored across the diagonal are the same expressions."""
    import casadi

    predicted = casadi.mtimes([jacobian, covariance, jacobian.T]) + casadi.diag(added)
    return casadi.tril2symm(casadi.tril(predicted))
