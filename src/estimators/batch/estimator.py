"""The batch estimator: all samples at once."""

from __future__ import annotations

import time
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from estimators.batch.identification import not_identified
from estimators.batch.problem import nonlinear_search
from estimators.batch.torque_fit import TorqueFit, weak_fit
from fricmodels.drive import Drive, rest_width
from fricmodels.estimator import Estimator, EstimatorSettings
from fricmodels.fit import Fit, Status
from fricmodels.recording import Recording

Array = NDArray[np.float64]


class BatchSettings(EstimatorSettings):
    """Settings of :class:`Batch`.

    Attributes:
        objective: what is made small, the error of the torque or that of the simulated velocity.
        form: how the acceleration enters a torque fit: by bumps (``weak``).
        width: samples that a bump spans; chosen for the smallest standard errors where it is not given.
    """

    objective: Literal["torque"] = "torque"
    form: Literal["weak"] = "weak"
    width: int | None = Field(default=None, ge=8)


class Batch(Estimator):
    r"""Least squares over the whole recording.

    The *torque* objective makes the error of :math:`J\dot\omega + \tau_F = \tau_m - \tau_L` small, in weak form, with the
    linear parameters eliminated (variable projection). Standard errors hold for autocorrelated residuals.
    """

    name = "batch"
    summary = "least squares over the whole recording: torque error in weak form"
    Settings = BatchSettings

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Estimate the free parameters; see :class:`BatchSettings` for the objectives."""
        started = time.perf_counter()
        resting = np.abs(recording.velocity) <= rest_width(recording)
        result = weak_fit(drive, recording, self.settings.width, resting, recording.velocity)
        return self._report(drive, recording, result, time.perf_counter() - started)

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
                "bump_samples": result.width,
            },
        )


def _told_apart(drive: Drive, recording: Recording) -> tuple[Array, Array]:
    """Return the range of each nonlinear parameter that its scan covers, a factor of ten wider on either side."""
    lower, upper = np.full(len(drive.keys), -np.inf), np.full(len(drive.keys), np.inf)
    search = nonlinear_search(drive, recording)
    places = [i for i, p in enumerate(drive.parameters) if not p.linear]
    for place, starts, logarithmic in zip(places, search.starts, search.logarithmic, strict=True):
        if logarithmic and len(starts) > 1:
            lower[place], upper[place] = min(starts) / 10.0, max(starts) * 10.0
    return lower, upper
