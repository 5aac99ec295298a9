"""The built-in estimators, one a file."""

from __future__ import annotations

from estimators.batch import Batch
from estimators.constant_velocity import ConstantVelocity
from estimators.detchmendy_sridhar import DetchmendySridhar
from estimators.ekf import ExtendedKalman
from estimators.rls import RecursiveLeastSquares
from fricmodels.estimator import Estimator
from fricmodels.hookspecs import hookimpl


@hookimpl
def fricmodels_estimators() -> list[type[Estimator]]:
    """Return the built-in estimators."""
    return [DetchmendySridhar, ExtendedKalman, Batch, RecursiveLeastSquares, ConstantVelocity]
