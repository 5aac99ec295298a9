"""Small least-squares problems with bounds, from their normal equations in scaled columns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_NOTHING = 1e-280
"""Columns whose square is less have no digits left: they are zero."""
RANK_TOLERANCE = 1e-11
"""Eigenvalues of the scaled normal matrix below this are rounding: the direction is not in the data."""


@dataclass(frozen=True)
class NormalEquations:
    """``XᵀX`` and ``Xᵀy`` in columns of unit length, with the inverse of the part that the data determine.

    Attributes:
        size: length of each column of X.
        gram: XᵀX of the scaled columns.
        values, vectors: its eigenvalues (ascending) and eigenvectors.
        right: Xᵀy of the scaled columns.
    """

    size: Array
    gram: Array
    values: Array
    vectors: Array
    right: Array

    @classmethod
    def of(cls, gram: Array, right: Array) -> NormalEquations:
        """Scale and decompose. Columns that are not finite, as of a state that runs away, determine nothing."""
        if not np.isfinite(gram).all():
            gram = np.zeros_like(gram)
            right = np.zeros_like(right)
        square = gram.diagonal()
        size = np.sqrt(np.where(square > _NOTHING, square, 1.0))
        scaled = gram / (size[:, None] * size)
        values, vectors = np.linalg.eigh(scaled)
        return cls(size, scaled, values, vectors, right / size)

    @property
    def rank(self) -> int:
        """Number of directions that the data determine."""
        return int((self.values > RANK_TOLERANCE).sum())

    @property
    def null(self) -> Array:
        """Directions, in scaled columns, that the data do not determine, shape (n, n − rank)."""
        return self.vectors[:, self.values <= RANK_TOLERANCE]

    @cached_property
    def _inverse_values(self) -> Array:
        return np.where(self.values > RANK_TOLERANCE, 1.0 / np.maximum(self.values, RANK_TOLERANCE), 0.0)

    @cached_property
    def inverse(self) -> Array:
        """(XᵀX)⁻¹ in the original columns, of the part that the data determine."""
        return np.asarray((self.vectors * self._inverse_values) @ self.vectors.T / (self.size[:, None] * self.size))

    @property
    def first_alone(self) -> float:
        """What the first column has that the others do not explain, squared; infinite where they explain it all."""
        own = float(self.vectors[0] ** 2 @ self._inverse_values) / float(self.size[0]) ** 2
        return 1.0 / own if own > 0.0 else math.inf

    def solve(self, constraints: Array, limits: Array) -> Array:
        """Return the least-squares solution subject to ``constraints @ x ≥ limits``."""
        free = self.inverse @ (self.right * self.size)
        slack = constraints @ free - limits
        if np.all(slack >= -1e-12 * np.abs(constraints) @ np.abs(free)):
            return np.asarray(free)
        root = np.sqrt(np.maximum(self.values, RANK_TOLERANCE))
        back = self.vectors / root / self.size[:, None]
        return free + back @ _least_distance(constraints @ back, -slack)


def _least_distance(matrix: Array, bound: Array) -> Array:
    """Return the shortest z with ``matrix @ z ≥ bound`` (Lawson and Hanson, Solving Least Squares Problems, ch. 23)."""
    from scipy.optimize import nnls

    rows = np.linalg.norm(matrix, axis=1)
    rows = np.where(rows > 0.0, rows, 1.0)
    scaled, reach = matrix / rows[:, None], bound / rows
    unit = float(np.max(np.abs(reach), initial=0.0)) or 1.0
    stacked = np.vstack([scaled.T, reach / unit])
    target = np.zeros(len(stacked))
    target[-1] = 1.0
    dual, _ = nnls(stacked, target)
    residual = stacked @ dual - target
    return np.asarray(-residual[:-1] / residual[-1] * unit)
