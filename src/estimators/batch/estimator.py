"""The batch estimator: all samples at once."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from estimators.batch.derivative_form import derivative_fit
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError, InputError
from fricmodels.estimator import Estimator, EstimatorSettings, Solution
from fricmodels.fit import Status
from fricmodels.recording import Recording
from fricmodels.signals import Preparation
from fricmodels.weakform.estimate import Estimate, estimate
from fricmodels.weakform.identification import not_identified, searched_range
from fricmodels.weakform.nonlinear import Plan, check_start
from fricmodels.weakform.prepared import prepared


class BatchSettings(EstimatorSettings):
    """Settings of :class:`Batch`.

    Attributes:
        objective: what is made small: the error of the torque, that of the simulated velocity along the measured one
            (``simulation``), or that of the simulated position (``position``), see :mod:`fricmodels.motion.fit`.
        horizon: samples after which a simulated position starts anew from the measured one; each run in one piece if
            not given.
        loss: of the position error, squared or absolute.
        form: how the acceleration enters a torque fit: through test functions (``weak``), or as the derivative of a
            filtered velocity (``derivative``).
        width: samples that a test function spans; as the noise of the velocity asks for if not given.
        velocity: what friction is evaluated at: the ``measured`` velocity, smoothed; or (``auto``) the one that the
            fitted model predicts, where that is more certain.
        preparation: filters of the derivative form.
        start: values that nonlinear parameters start from, by key, in place of a search.
        samples: most samples of a simulation fit; a longer record is represented by pieces.
        max_seconds: of each of its four stages.
    """

    objective: Literal["torque", "simulation", "position"] = "torque"
    horizon: int | None = Field(default=None, ge=1)
    loss: Literal["squares", "absolute"] = "squares"
    form: Literal["weak", "derivative"] = "weak"
    width: int | None = Field(default=None, ge=8)
    velocity: Literal["auto", "measured"] = "auto"
    preparation: Preparation = Preparation(method="butterworth", decimate=10)
    start: dict[str, float] = Field(default_factory=dict)
    samples: int = Field(default=5000, ge=80)
    max_seconds: float = Field(default=20.0, gt=0.0)


class Batch(Estimator):
    r"""Least squares over the whole recording.

    The *torque* objective makes the error of :math:`J\dot\omega + \tau_F = \tau_m - \tau_L` small, in weak form,
    the linear parameters eliminated (variable projection): the same fit as that of ``compare``, see
    :mod:`fricmodels.weakform.estimate`. It bears a model that is not quite right. The *simulation* objective makes the
    error of the simulated velocity small; where the model is right and noise white, nothing is more precise, but an
    error of the model adds up over the record. The *position* objective makes the error of the simulated position
    small, in one piece or in windows of a ``horizon``. Standard errors hold for autocorrelated residuals.
    """

    name = "batch"
    summary = "least squares over the whole recording: torque error (weak form), or that of the simulated motion"
    Settings = BatchSettings
    carries_states = True

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Solution:
        """Estimate the free parameters; see :class:`BatchSettings` for the objectives."""
        check_start(drive, self.settings.start)
        ready = prepared(recording)
        found = self._weak(drive, ready)
        if self.settings.objective == "torque" and self.settings.form == "weak":
            notes = {"relative_error": found.residual_percent / 100, "shift_s": found.shift}
            return Solution(
                found.parameters,
                found.covariance,
                status=Status.FAILED if found.message else Status.OK,
                message=found.message,
                estimated=tuple(found.standard_errors),
                not_identified=found.not_identified,
                notes=notes,
            )
        if self.settings.objective == "position":
            return self._motion(drive, ready, found)
        nonlinear = {p.key: found.parameters[p.key] for p in drive.parameters if not p.linear}
        if self.settings.objective == "simulation":
            from estimators.batch.simulation_fit import simulation_fit

            values = np.array([found.parameters[key] for key in drive.keys])
            refined = simulation_fit(drive, ready, values, self.settings.samples, self.settings.max_seconds)
            outcome, notes = refined.outcome, {"samples": refined.samples}
            notes["root_mean_square_velocity_error"] = refined.velocity_error
        else:
            outcome, error = derivative_fit(drive, recording, self.settings.preparation, Plan(start=nonlinear))
            notes = {"relative_error": error}
        reasons = not_identified(
            drive, outcome.values, outcome.covariance, outcome.undetermined, searched_range(drive, ready)
        )
        return Solution(
            dict(zip(drive.keys, outcome.values.tolist(), strict=True)),
            outcome.covariance,
            status=Status.OK if outcome.succeeded else Status.FAILED,
            message=outcome.message,
            not_identified=reasons,
            notes=notes,
        )

    def _motion(self, drive: Drive, ready: Recording, found: Estimate) -> Solution:
        """Bring the simulated position nearest to the measured one, from the fit of the torque."""
        from fricmodels.motion import Simulator, fit_motion, torque_between_samples

        if not ready.measures("position"):
            raise EstimationError(f"objective 'position' needs the position, which '{ready.name}' does not have")
        try:
            between = torque_between_samples(drive, found.parameters, ready)
            simulator = Simulator(drive, ready, horizon=self.settings.horizon, between_samples=between)
        except InputError as error:
            raise EstimationError(str(error)) from None
        fitted = fit_motion(simulator, [found.parameters], loss=self.settings.loss)
        values = np.array([fitted.parameters[key] for key in drive.keys])
        reasons = not_identified(drive, values, fitted.covariance, fitted.undetermined, searched_range(drive, ready))
        return Solution(
            {key: fitted.parameters[key] for key in drive.keys},
            fitted.covariance,
            message="" if fitted.converged else "the search was cut off before it converged",
            not_identified=reasons,
            notes={"simulated_position_error": fitted.errors.position, "simulations": fitted.evaluations},
        )

    def _weak(self, drive: Drive, ready: Recording) -> Estimate:
        try:
            return estimate(
                drive,
                ready,
                self.settings.start,
                width=self.settings.width,
                model_velocity=self.settings.velocity == "auto",
            )[1]
        except InputError as error:
            raise EstimationError(str(error)) from None
