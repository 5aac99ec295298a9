"""filterpy's unscented Kalman filter with its sigma points propagated together."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Propagate = Callable[..., Array]


_ROUNDING = 1e-13
_NEGATIVE = 1e-6
"""Pivot of a Cholesky factorisation over its own variance: zero but for rounding, and below zero beyond rounding."""


def upper_root(covariance: Array) -> Array:
    """Return U with P = UᵀU, upper triangular, for a covariance that may be singular.

    A drive that sticks at every sigma point has a velocity without variance, and one that starts from there has a
    velocity which its parameters determine. Where a pivot is zero so is its row, which leaves the others as they are.

    Raises:
        numpy.linalg.LinAlgError: where P is not finite or has a negative variance.
    """
    root = np.zeros_like(covariance)
    if not _factor(np.array(covariance, dtype=float), root):
        finite = np.all(np.isfinite(covariance))
        raise np.linalg.LinAlgError(f"the covariance {'has a negative variance' if finite else 'is not finite'}")
    return root


@njit(cache=True, nogil=True)
def _factor(left: Any, root: Any) -> bool:
    """Write the upper root of a matrix that is overwritten, where it has one; zeros are kept."""
    count = len(left)
    for i in range(count):
        for j in range(count):
            if not math.isfinite(left[i, j]):
                return False
    variance = np.diag(left).copy()
    for i in range(count):
        if left[i, i] < -_NEGATIVE * variance[i] or variance[i] < 0:
            return False
        if left[i, i] > _ROUNDING * variance[i]:
            scale = math.sqrt(left[i, i])
            for j in range(i, count):
                root[i, j] = left[i, j] / scale
            for j in range(i + 1, count):
                for k in range(j, count):
                    left[j, k] -= root[i, j] * root[i, k]
    return True


class _Points(MerweScaledSigmaPoints):  # type: ignore[misc]
    """filterpy's sigma points, drawn together."""

    def sigma_points(self, x: Array, P: Array) -> Array:
        """Return x and x ± √(n + λ) Uᵢ, shape (2n + 1, n)."""
        reach = self.alpha**2 * (self.n + self.kappa)
        root = self.sqrt(reach * P)
        points = np.empty((2 * self.n + 1, self.n))
        points[0] = x
        points[1 : self.n + 1] = x + root
        points[self.n + 1 :] = x - root
        return points


class BatchedUnscentedFilter(UnscentedKalmanFilter):  # type: ignore[misc]
    """Unscented Kalman filter whose transition takes all 2n + 1 sigma points at once.

    The sigma points of mean x and covariance P = UᵀU are x and x ± √(n + λ) Uᵢ with λ = α²(n + κ) − n (van der Merwe
    2004); filterpy draws them, and does all that follows.

    Args:
        propagate: ``propagate(points, **inputs)``, shapes (2n + 1, n) → (2n + 1, n).
        observe: what is measured of one point, (n,) → (dim_z,).
        order, observed: n and dim_z. alpha, beta, kappa: of the sigma points.
    """

    def __init__(
        self,
        propagate: Propagate,
        observe: Callable[[Array], Array],
        *,
        order: int,
        observed: int = 1,
        alpha: float = 1.0,
        beta: float = 0.0,
        kappa: float = 0.0,
    ) -> None:
        points = _Points(order, alpha, beta, kappa, sqrt_method=upper_root)
        super().__init__(dim_x=order, dim_z=observed, dt=1.0, hx=observe, fx=None, points=points)
        self._propagate = propagate

    def compute_process_sigmas(self, dt: float, fx: Any = None, **inputs: Any) -> None:
        """Draw the sigma points and send them through the transition together."""
        self.sigmas_f: Array = self._propagate(self.points_fn.sigma_points(self.x, self.P), **inputs)

    def cross_variance(self, x: Array, z: Array, sigmas_f: Array, sigmas_h: Array) -> Array:
        """Return the covariance of state and measurement, shape (n, dim_z), over all sigma points at once."""
        return np.asarray((self.Wc[:, None] * (sigmas_f - x)).T @ (sigmas_h - z))
