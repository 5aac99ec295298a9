"""The estimator ``ukf``: the problem of the extended filter, solved with sigma points instead of derivatives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from fricmodels.arrays import Array
from fricmodels.filtering import FilterProblem, KalmanEstimator, KalmanSettings, Trajectory, transition
from fricmodels.kernels import Scan
from fricmodels.recording import Recording

if TYPE_CHECKING:
    from fricmodels_ukf.sigma_points import BatchedUnscentedFilter


class UnscentedKalmanSettings(KalmanSettings):
    """Settings; what is left out comes from the data, as for ``ekf``."""

    alpha: float = Field(1.0, gt=0, description="spread of the sigma points")
    beta: float = Field(2.0, ge=0, description="weight of the middle point in the covariance; 2 for a Gaussian state")
    kappa: float = Field(0.0, ge=0, description="a further spread")


class UnscentedKalman(KalmanEstimator):
    """Unscented Kalman filter of velocity, internal states and constant parameters.

    Scales, start, bounds and noise are those of the extended filter (``ekf``); only the propagation differs: the
    2n + 1 sigma points go through the drive's own transition, sticking and reversals included, without derivatives.
    A nonlinear parameter, or the inertia, is taken at its bound where a sigma point lies beyond it. Standard errors
    are by the distance to an unbiased fit, :mod:`fricmodels.interval`. A covariance that stops being positive
    definite, or an estimate that stops being finite, is reported as ``diverged``.

    Source: S. J. Julier, J. K. Uhlmann, "Unscented filtering and nonlinear estimation", Proc. IEEE 92(3), 2004,
    401–422; E. A. Wan, R. van der Merwe, "The unscented Kalman filter for nonlinear estimation", IEEE AS-SPCC, 2000,
    153–158.
    """

    name = "ukf"
    summary = "unscented Kalman filter (filterpy, sigma points through the compiled law)"
    Settings = UnscentedKalmanSettings
    filters_positions = True

    def run(self, problem: FilterProblem, recording: Recording) -> Trajectory:
        """Filter with sigma points."""
        return problem.run_stepwise(recording, _filter(problem, self.settings))


def propagation_step(problem: FilterProblem) -> Any:
    """Build ``[Δt, u, x] → f(x, u, Δt)`` as a recursion without memory: each row is a sigma point of its own."""
    import casadi

    step = transition(problem.space)
    rows = casadi.vertcat(step.duration, problem.space.u, problem.space.x)
    empty = casadi.SX(0, 1)
    return casadi.Function("propagation", [empty, rows, problem.space.known], [empty, step.following], {"cse": True})


def _filter(problem: FilterProblem, settings: UnscentedKalmanSettings) -> BatchedUnscentedFilter:
    from fricmodels_ukf.sigma_points import BatchedUnscentedFilter

    drive, moving = problem.drive, problem.moving
    scan = Scan(propagation_step(problem))
    bounds = np.full((2, problem.order), [[-np.inf], [np.inf]])
    held = [key == drive.inertia_key or not p.linear for key, p in zip(drive.keys, drive.parameters, strict=True)]
    bounds[:, moving:] = np.where(held, problem.physical_bounds, bounds[:, moving:])

    def propagate(points: Array, duration: float, inputs: Array) -> Array:
        before = np.tile([duration, *inputs], (len(points), 1))
        _, following, _ = scan([], np.hstack([before, np.clip(points, *bounds)]), problem.known)
        following[:, moving:] = points[:, moving:]
        return following

    class Filter(BatchedUnscentedFilter):
        def step(self, duration: float, inputs: Array) -> None:
            self.Q = np.diag(duration * problem.walk)
            self.predict(duration=duration, inputs=inputs)

        def observe(self, measured: float) -> tuple[float, float]:
            self.update(np.array([measured]))
            return float(self.y.item()), float(self.S.item())

    kalman = Filter(
        propagate,
        lambda x: x[problem.measured, None],
        order=problem.order,
        alpha=settings.alpha,
        beta=settings.beta,
        kappa=settings.kappa,
    )
    kalman.R = np.array([[problem.measurement]])
    return kalman
