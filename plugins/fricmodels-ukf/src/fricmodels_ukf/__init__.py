"""An unscented Kalman filter of velocity, internal states and parameters, as a plugin of fricmodels."""

from __future__ import annotations

from fricmodels import Estimator, hookimpl
from fricmodels_ukf.estimator import UnscentedKalman, UnscentedKalmanSettings

__all__ = ["UnscentedKalman", "UnscentedKalmanSettings", "fricmodels_estimators"]


@hookimpl
def fricmodels_estimators() -> list[type[Estimator]]:
    """Return the estimator of this distribution."""
    return [UnscentedKalman]
