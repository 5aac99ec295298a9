"""Extended Kalman filter: filterpy's, and a compiled twin for long records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from pydantic import Field

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.estimator import OnlineFilter, SequentialEstimator, usable
from fricmodels.filtering import FilterProblem, KalmanEstimator, KalmanSettings, ProblemOnline, Trajectory, transition
from fricmodels.filtering.kalman import kalman_step
from fricmodels.filtering.normalisation import NormalisedSpace
from fricmodels.filtering.stored_problem import checked_state, problem_of
from fricmodels.kernels import Scan
from fricmodels.recording import Recording


class ExtendedKalmanSettings(KalmanSettings):
    """Settings; what is left out comes from the data."""

    engine: Literal["compiled", "filterpy"] = Field("compiled", description="the compiled twin, or filterpy itself")


class ExtendedKalman(KalmanEstimator, SequentialEstimator):
    """Extended Kalman filter of velocity, internal states and constant parameters.

    Start and noise are found as :class:`fricmodels.filtering.KalmanEstimator` says; standard errors by the distance to
    an unbiased fit, :mod:`fricmodels.interval`.
    """

    name = "ekf"
    summary = "extended Kalman filter (filterpy, or its compiled twin)"
    Settings = ExtendedKalmanSettings
    filters_positions = True

    def run(self, problem: FilterProblem, recording: Recording) -> Trajectory:
        """Filter with the engine that the settings name."""
        if self.settings.engine == "compiled":
            return problem.run(recording)
        return problem.run_stepwise(recording, _filterpy(problem))

    def start(self, drive: Drive, recording: Recording) -> OnlineFilter:
        """Return the filter before its first sample; it runs compiled whatever the engine, and takes velocities.

        Raises:
            InputError: where the settings say that positions are measured.
        """
        if self.settings.measured == "position":
            raise InputError("a filter beside a drive takes velocities; leave the setting 'measured' out")
        return ProblemOnline(self.problem(drive, usable(drive, recording)), self.name)

    def resume(self, state: Mapping[str, Any]) -> OnlineFilter:
        """Return a filter that goes on where one was saved; the settings are the saved ones."""
        saved = checked_state(state, self.name)
        return ProblemOnline(problem_of(saved["problem"], kalman_step), self.name, saved)


def prediction_step(space: NormalisedSpace) -> Any:
    """Build the step ``x → f(x, u)`` with the elements of F, column by column, as its output."""
    import casadi

    step = transition(space)
    return casadi.Function(
        "prediction",
        [space.x, casadi.vertcat(step.duration, space.u), space.known],
        [step.following, casadi.vec(casadi.densify(step.jacobian))],
        {"cse": True},
    )


def _filterpy(problem: FilterProblem) -> Any:
    """Return filterpy's ExtendedKalmanFilter of a problem, as a :class:`fricmodels.filtering.SampleFilter`.

    The only Python per sample is filterpy's own and the calls of the compiled prediction.
    """
    from filterpy.kalman import ExtendedKalmanFilter

    n = problem.order
    prediction = Scan(prediction_step(problem.space))
    observed = np.zeros((1, n))
    observed[0, problem.measured] = 1.0

    class Filter(ExtendedKalmanFilter):  # type: ignore[misc]
        def predict_x(self, u: Any = 0) -> None:
            following, jacobian, _ = prediction(self.x, u[None, :], problem.known)
            self.x: Array = following
            self.F = jacobian.reshape(n, n).T
            self.Q = u[0] * np.diag(problem.walk)

        def step(self, duration: float, inputs: Array) -> None:
            self.predict(np.concatenate([[duration], inputs]))

        def observe(self, measured: float) -> tuple[float, float]:
            self.update(np.array([measured]), lambda _: observed, lambda x: x[problem.measured, None])
            return float(self.y.item()), float(self.S.item())

    kalman = Filter(dim_x=n, dim_z=1)
    kalman.R = np.array([[problem.measurement]])
    return kalman
