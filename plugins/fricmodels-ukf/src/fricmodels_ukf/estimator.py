"""The estimator ``ukf``: the problem of the extended filter, solved with sigma points instead of derivatives."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from estimators.ekf import ExtendedKalman, ExtendedKalmanSettings
from estimators.normalisation import NormalisedSpace
from estimators.preparation import Hold, usable
from estimators.result import diverged_fit, filtered_fit
from estimators.sequential import FilterProblem, Trajectory, normalised_bounds, pack, projected, unpack
from estimators.transition import transition
from fricmodels.drive import Drive
from fricmodels.estimator import Estimator, EstimatorSettings
from fricmodels.fit import Fit
from fricmodels.kernels import Scan
from fricmodels.recording import Recording

if TYPE_CHECKING:
    from fricmodels_ukf.sigma_points import BatchedUnscentedFilter

Array = NDArray[np.float64]


class UnscentedKalmanSettings(EstimatorSettings):
    """Settings; what is left out comes from the data, as for ``ekf``."""

    alpha: float = Field(1.0, gt=0, description="spread of the sigma points")
    beta: float = Field(2.0, ge=0, description="weight of the middle point in the covariance; 2 for a Gaussian state")
    kappa: float = Field(0.0, ge=0, description="a further spread")
    velocity_noise: float | None = Field(None, gt=0, description="standard deviation of the velocity noise, SI")
    model_noise: float | None = Field(None, ge=0, description="white torque error of a sample over the RMS torque")
    drift: float = Field(0.0, ge=0, description="random walk of each parameter in a cycle, over its initial deviation")
    initial_inertia_deviation: float = Field(0.3, gt=0, description="relative, where the inertia is estimated")
    substeps: int | None = Field(None, ge=1, description="steps between samples; by stability where not given")
    torque: Hold = Field("linear", description="motor torque between samples: linear, or held")


class UnscentedKalman(Estimator):
    """Unscented Kalman filter of velocity, internal states and constant parameters.

    Scales, start, bounds and noise are those of the extended filter (``ekf``); only the propagation differs: the
    2n + 1 sigma points go through the drive's own transition, sticking and reversals included, without derivatives.
    A nonlinear parameter, or the inertia, is taken at its bound where a sigma point lies beyond it. Standard errors
    are the filter's own, widened where the innovations are larger or more alike from sample to sample than the filter
    believes. A covariance that stops being positive definite, or an estimate that stops being finite, is reported as
    ``diverged``.

    Source: S. J. Julier, J. K. Uhlmann, "Unscented filtering and nonlinear estimation", Proc. IEEE 92(3), 2004,
    401–422; E. A. Wan, R. van der Merwe, "The unscented Kalman filter for nonlinear estimation", IEEE AS-SPCC, 2000,
    153–158.
    """

    name = "ukf"
    summary = "unscented Kalman filter (filterpy, sigma points through the compiled law)"
    Settings = UnscentedKalmanSettings
    carries_states = True

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Filter the recording; see the class.

        Raises:
            EstimationError: for a recording that cannot be filtered.
        """
        began = time.perf_counter()
        kept = usable(drive, recording)
        shared = self.settings.model_dump(exclude={"alpha", "beta", "kappa"})
        problem = ExtendedKalman(ExtendedKalmanSettings(**shared)).problem(drive, kept)
        trajectory = run(problem, kept, self.settings)
        if trajectory.diverged_at is not None:
            what = "the estimate or its covariance stopped being finite and positive"
            return diverged_fit(self, problem, kept, trajectory, began, what)
        return filtered_fit(self, problem, kept, trajectory, began)


def propagation_step(space: NormalisedSpace) -> Any:
    """Build ``[Δt, u, x] → f(x, u, Δt)`` as a recursion without memory: each row is a sigma point of its own."""
    import casadi

    step = transition(space)
    rows = casadi.vertcat(step.duration, space.u, space.x)
    empty = casadi.SX(0, 1)
    return casadi.Function("propagation", [empty, rows, space.known], [empty, step.following], {"cse": True})


def run(problem: FilterProblem, recording: Recording, settings: UnscentedKalmanSettings) -> Trajectory:
    """Filter a recording in SI units from its first sample to its last."""
    n, moving = problem.order, problem.moving
    ends = np.cumsum([problem.space.known.numel(), 1, n, n - moving])
    known, (noise,), walk, lower, upper = np.split(problem.constants, ends)
    kalman = _filter(problem, known, settings)
    kalman.R = np.array([[noise]])
    memory = problem.initial_memory()
    outputs = np.full((len(recording), 2 * n + 2), np.nan)
    scaled = recording.scaled(problem.scales)
    diverged = None
    for number in np.unique(recording.run):
        where = np.flatnonzero(recording.run == number)
        part = scaled.select(where)
        memory = problem.restarted(memory, float(part.velocity[0]))
        kalman.x, kalman.P = memory[:n].copy(), unpack(memory[n:], n)
        outputs[where[0], :n], outputs[where[0], n : 2 * n] = memory[:n], np.diag(kalman.P)
        sample = 0
        for duration, weight, measured, *inputs in problem.rows(part).tolist():
            kalman.Q = np.diag(duration * walk)
            try:
                kalman.predict(duration=duration, inputs=inputs)
                if not weight > 0:
                    continue
                sample += 1
                kalman.update(np.array([measured]))
            except np.linalg.LinAlgError:
                diverged = int(where[min(sample + (weight > 0), len(where) - 1)])
                break
            kalman.x = projected(kalman.x, kalman.P, lower, upper, problem.drive)
            deviations = np.diag(kalman.P)
            if not (np.all(np.isfinite(kalman.x)) and np.all(deviations >= 0)):
                diverged = int(where[sample])
                break
            outputs[where[sample]] = [*kalman.x, *deviations, kalman.y.item(), kalman.S.item()]
        memory = np.concatenate([kalman.x, pack(kalman.P)])
        if diverged is not None:
            break
    columns = (outputs[:, :n], outputs[:, n : 2 * n], outputs[:, 2 * n], outputs[:, 2 * n + 1])
    return Trajectory(recording.time, recording.run, *columns, memory, diverged)


def _filter(problem: FilterProblem, known: Array, settings: UnscentedKalmanSettings) -> BatchedUnscentedFilter:
    from fricmodels_ukf.sigma_points import BatchedUnscentedFilter

    drive, moving = problem.drive, problem.moving
    scan = Scan(propagation_step(problem.space))
    bounds = np.full((2, problem.order), [[-np.inf], [np.inf]])
    held = np.array(
        [key == drive.inertia_key or not p.linear for key, p in zip(drive.keys, drive.parameters, strict=True)]
    )
    bounds[:, moving:] = np.where(held, normalised_bounds(drive, problem.scales), bounds[:, moving:])

    def propagate(points: Array, duration: float, inputs: list[float]) -> Array:
        before = np.tile([duration, *inputs], (len(points), 1))
        _, following, _ = scan([], np.hstack([before, np.clip(points, *bounds)]), known)
        following[:, moving:] = points[:, moving:]
        return following

    return BatchedUnscentedFilter(
        propagate,
        lambda x: x[:1],
        order=problem.order,
        alpha=settings.alpha,
        beta=settings.beta,
        kappa=settings.kappa,
    )
