"""The batch estimator: all samples at once."""

from __future__ import annotations

import time
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from estimators.batch.identification import not_identified
from estimators.batch.problem import nonlinear_search
from estimators.batch.smoothing import explained_velocity
from estimators.batch.torque_fit import TorqueFit, derivative_fit, possible_widths, weak_fit
from fricmodels.drive import Drive
from fricmodels.estimator import Estimator, EstimatorSettings
from fricmodels.fit import Fit, Status
from fricmodels.recording import Recording
from fricmodels.signals import Preparation, noise, prepare, resting

Array = NDArray[np.float64]

MAX_ROUNDS = 8
"""Rounds of explaining the velocity by the fit and fitting again."""


class BatchSettings(EstimatorSettings):
    """Settings of :class:`Batch`.

    Attributes:
        objective: what is made small, the error of the torque or that of the simulated velocity.
        form: how the acceleration enters a torque fit: by bumps (``weak``), or as the derivative of a filtered
            velocity (``derivative``).
        width: samples that a bump spans. Where it is not given: the widest of which 24 fit side by side if noise
            hides the sign of the velocity, else the narrowest whose standard errors are about the smallest.
        velocity: what a weak form evaluates friction at: the velocity as ``measured``; one that the fitted model
            ``explained``, in rounds; ``auto`` explains where the drive rests or noise could hide the sign of its velocity.
        preparation: filters of the derivative form.
    """

    objective: Literal["torque"] = "torque"
    form: Literal["weak", "derivative"] = "weak"
    width: int | None = Field(default=None, ge=8)
    velocity: Literal["auto", "measured", "explained"] = "auto"
    preparation: Preparation = Preparation(method="butterworth", decimate=10)


class Batch(Estimator):
    r"""Least squares over the whole recording.

    The *torque* objective makes the error of :math:`J\dot\omega + \tau_F = \tau_m - \tau_L` small, in weak form, with
    the linear parameters eliminated (variable projection). Standard errors hold for autocorrelated residuals.
    """

    name = "batch"
    summary = "least squares over the whole recording: torque error in weak form"
    Settings = BatchSettings

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Estimate the free parameters; see :class:`BatchSettings` for the objectives."""
        started = time.perf_counter()
        if self.settings.form == "derivative":
            result = derivative_fit(drive, recording, self.settings.preparation)
        else:
            recording = _complete(drive, recording)
            result = self._weak(drive, recording)
        return self._report(drive, recording, result, time.perf_counter() - started)

    def _weak(self, drive: Drive, recording: Recording) -> TorqueFit:
        width, choice = self.settings.width, self.settings.velocity
        hidden = _sign_is_hidden(recording)
        if width is None and hidden:
            width = possible_widths(recording)[-1]
        still = resting(recording)
        result = weak_fit(drive, recording, width, still, recording.velocity)
        if choice == "measured" or (choice == "auto" and not (hidden or still.any())):
            return result
        for _ in range(MAX_ROUNDS):
            explained = explained_velocity(drive, dict(zip(drive.keys, result.values, strict=True)), recording)
            if explained is None:
                return result
            velocity, still = explained
            before, result = result, weak_fit(drive, recording, width, still, velocity)
            spread = np.sqrt(np.clip(np.diag(result.covariance), 0.0, None))
            if np.all(np.abs(result.values - before.values) <= 0.1 * spread):
                break
        return result

    def _report(self, drive: Drive, recording: Recording, result: TorqueFit, seconds: float) -> Fit:
        parameters = dict(zip(drive.keys, (float(value) for value in result.values), strict=True))
        parameters.setdefault(drive.inertia_key, drive.inertia or float("nan"))
        solution = result.solution
        place = np.empty(len(result.order), dtype=int)
        place[np.arange(len(result.order))] = result.order
        undetermined = solution.normal.null[place]
        reasons = not_identified(drive, result.values, result.covariance, undetermined, _told_apart(drive, recording))
        return Fit(
            model=drive.model.name,
            estimator=self.name,
            dataset=recording.name,
            parameters=parameters,
            covariance=result.covariance,
            estimated=drive.keys,
            status=Status.OK if solution.converged else Status.FAILED,
            message="" if solution.converged else f"no minimum after {solution.iterations} iterations",
            not_identified=reasons,
            seconds=seconds,
            provenance={
                "settings": self.settings.model_dump(),
                "recording": recording.checksum,
                "samples_per_equation": result.width,
                "relative_error": result.relative_error,
            },
        )


def _complete(drive: Drive, recording: Recording) -> Recording:
    """Return the recording with a velocity, and an acceleration where the model needs one."""
    lacking = "velocity" not in recording or ("acceleration" in drive.model.needs and "acceleration" not in recording)
    return prepare(recording) if lacking else recording


def _sign_is_hidden(recording: Recording) -> bool:
    """Return whether noise exceeds a tenth of what the velocity changes in a sampling interval."""
    changes = np.abs(np.diff(recording.velocity))
    usual = float(np.median(changes[changes > 0.0])) if np.any(changes > 0.0) else 0.0
    return noise(recording.time, recording.velocity, recording.run) > 0.1 * usual


def _told_apart(drive: Drive, recording: Recording) -> tuple[Array, Array]:
    """Return the range of each nonlinear parameter that its scan covers, a factor of ten wider on either side."""
    lower, upper = np.full(len(drive.keys), -np.inf), np.full(len(drive.keys), np.inf)
    search = nonlinear_search(drive, recording)
    places = [i for i, p in enumerate(drive.parameters) if not p.linear]
    for place, starts, logarithmic in zip(places, search.starts, search.logarithmic, strict=True):
        if logarithmic and len(starts) > 1:
            lower[place], upper[place] = min(starts) / 10.0, max(starts) * 10.0
    return lower, upper
