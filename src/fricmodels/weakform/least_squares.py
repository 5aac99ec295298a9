"""Small least-squares problems with bounds, from their normal equations in scaled columns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Mask

_NOTHING = 1e-280
"""Columns whose square is less have no digits left: they are zero."""
RANK_TOLERANCE = 1e-11
"""Eigenvalues of the scaled normal matrix below this are rounding: the direction is not in the data."""


_CERTAIN = 1e-8
"""A scaled normal matrix with a larger determinant has no eigenvalue below a third of it, and needs no eigenvectors."""


@dataclass(frozen=True)
class NormalEquations:
    """``XᵀX`` and ``Xᵀy`` in columns of unit length, with the inverse of the part that the data determine.

    Attributes:
        size: length of each column of X.
        gram: XᵀX of the columns as they are.
        right: Xᵀy of the columns as they are.
        quick: (XᵀX)⁻¹, where all directions are certainly determined.
    """

    size: Array
    gram: Array
    right: Array
    quick: Array | None

    @classmethod
    def of(cls, gram: Array, right: Array) -> NormalEquations:
        """Scale, and invert. Columns that are not finite, as of a state that runs away, determine nothing."""
        from fricmodels.kernels.small import invert

        size, inverse = np.empty(len(gram)), np.empty(gram.shape)
        if invert(gram, _NOTHING, size, inverse) > _CERTAIN:  # which no products are that are not finite
            return cls(size, gram, right, inverse)
        if not np.isfinite(gram).all():
            gram, right, size = np.zeros_like(gram), np.zeros_like(right), np.ones(len(gram))
        return cls(size, gram, right, None)

    @cached_property
    def _eigen(self) -> tuple[Array, Array]:
        """Eigenvalues (ascending) and eigenvectors of the scaled products."""
        values, vectors = np.linalg.eigh(self.gram / (self.size[:, None] * self.size))
        return values, vectors

    @property
    def values(self) -> Array:
        """Eigenvalues of the scaled products, ascending."""
        return self._eigen[0]

    @property
    def vectors(self) -> Array:
        """Eigenvectors of the scaled products."""
        return self._eigen[1]

    @property
    def rounding(self) -> float:
        """Share of its largest eigenvalue to which the inverse, in scaled columns, is true where the products are."""
        seen = self.values[self.values > RANK_TOLERANCE]
        return float(len(seen) * np.finfo(float).eps * seen[-1] / seen[0]) if len(seen) else 1.0

    @property
    def null(self) -> Array:
        """Directions, in scaled columns, that the data do not determine, shape (n, n − rank)."""
        if self.quick is not None:
            return np.zeros((len(self.gram), 0))
        return self.vectors[:, self.values <= RANK_TOLERANCE]

    @cached_property
    def _inverse_values(self) -> Array:
        return np.where(self.values > RANK_TOLERANCE, 1.0 / np.maximum(self.values, RANK_TOLERANCE), 0.0)

    @cached_property
    def inverse(self) -> Array:
        """(XᵀX)⁻¹ in the original columns, of the part that the data determine."""
        if self.quick is not None:
            return self.quick
        found = (self.vectors * self._inverse_values) @ self.vectors.T / (self.size[:, None] * self.size)
        some = np.diag(self.gram) > _NOTHING  # a column of zeros has no part in any direction, not even by rounding
        return np.asarray(np.where(some & some[:, None], found, 0.0))

    @property
    def solved(self) -> Array:
        """The least-squares solution, shape (n,); what is not determined is nothing."""
        return np.asarray(self.inverse @ self.right)

    def solve(self, constraints: Array, limits: Array) -> Array:
        """Return the least-squares solution subject to ``constraints @ x ≥ limits``.

        It is not finite where the products with the target are not.
        """
        free = self.solved
        slack = constraints @ free - limits
        if not len(slack) or slack.min() >= 0.0 or np.all(slack >= -1e-12 * np.abs(constraints) @ np.abs(free)):
            return np.asarray(free)
        if not np.all(np.isfinite(free)):
            return np.asarray(free)
        root = np.sqrt(np.maximum(self.values, RANK_TOLERANCE))
        back = self.vectors / root / self.size[:, None]
        step, active = _least_distance(constraints @ back, -slack)
        found = free + back @ step
        for row in np.flatnonzero(active & (np.count_nonzero(constraints, axis=1) == 1)).tolist():
            place = int(np.flatnonzero(constraints[row])[0])
            found[place] = limits[row] / constraints[row, place]  # it is at its bound, not beside it by rounding
        return found


def first_alone(gram: Array) -> float:
    """Return what the first column has that the others do not explain, squared; infinite where they explain it all.

    Args:
        gram: products of the columns, shape (n, n).
    """
    from fricmodels.kernels import small

    found: float = small.first_alone(gram, _NOTHING, _CERTAIN)
    if found > 0.0:
        return found
    own = float(NormalEquations.of(gram, gram[0]).inverse[0, 0])
    return 1.0 / own if own > 0.0 else math.inf


def _least_distance(matrix: Array, bound: Array) -> tuple[Array, Mask]:
    """Return the shortest z with ``matrix @ z ≥ bound``, and which of these rows are equal to their bounds.

    Source: C. L. Lawson, R. J. Hanson, "Solving Least Squares Problems", 1974, ch. 23.
    """
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
    return np.asarray(-residual[:-1] / residual[-1] * unit), dual > 0.0
