"""filterpy's unscented Kalman filter with its sigma points propagated together."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
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
    if not np.all(np.isfinite(covariance)):
        raise np.linalg.LinAlgError("the covariance is not finite")
    try:
        return np.asarray(np.linalg.cholesky(covariance).T)
    except np.linalg.LinAlgError:
        left, root = covariance.copy(), np.zeros_like(covariance)
    for i, variance in enumerate(np.diag(covariance)):
        if left[i, i] < -_NEGATIVE * variance or variance < 0:
            raise np.linalg.LinAlgError("the covariance has a negative variance")
        if left[i, i] > _ROUNDING * variance:
            root[i, i:] = left[i, i:] / np.sqrt(left[i, i])
            left -= np.outer(root[i], root[i])
    return root


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
        points = MerweScaledSigmaPoints(order, alpha, beta, kappa, sqrt_method=upper_root)
        super().__init__(dim_x=order, dim_z=observed, dt=1.0, hx=observe, fx=None, points=points)
        self._propagate = propagate

    def compute_process_sigmas(self, dt: float, fx: Any = None, **inputs: Any) -> None:
        """Draw the sigma points and send them through the transition together."""
        self.sigmas_f: Array = self._propagate(self.points_fn.sigma_points(self.x, self.P), **inputs)
