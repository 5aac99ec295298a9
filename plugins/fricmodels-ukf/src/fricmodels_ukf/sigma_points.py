"""filterpy's unscented Kalman filter with its sigma points propagated together."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from numpy.typing import NDArray

Array = NDArray[np.float64]
Propagate = Callable[..., Array]


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
        points = MerweScaledSigmaPoints(order, alpha, beta, kappa)
        super().__init__(dim_x=order, dim_z=observed, dt=1.0, hx=observe, fx=None, points=points)
        self._propagate = propagate

    def compute_process_sigmas(self, dt: float, fx: Any = None, **inputs: Any) -> None:
        """Draw the sigma points and send them through the transition together."""
        self.sigmas_f: Array = self._propagate(self.points_fn.sigma_points(self.x, self.P), **inputs)
