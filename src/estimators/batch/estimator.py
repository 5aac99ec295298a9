"""The batch estimator: all samples at once."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from estimators.batch.identification import drowned, lost_in_noise, not_identified, searched_range, to_hold
from estimators.batch.problem import Outcome, Plan, check_start
from estimators.batch.smoothing import explained_velocity, prediction_error, sought
from estimators.batch.torque_fit import TorqueFit, derivative_fit, possible_widths, weak_fit
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.estimator import Estimator, EstimatorSettings
from fricmodels.fit import Fit, Status
from fricmodels.recording import Recording
from fricmodels.signals import Preparation, noise, prepare, resting

Array = NDArray[np.float64]

MAX_ROUNDS = 6
"""Rounds of explaining the velocity by the fit and fitting again."""
WORSE = 1.1
"""A round whose squared error of prediction is larger than the best by this factor has gone astray."""


class BatchSettings(EstimatorSettings):
    """Settings of :class:`Batch`.

    Attributes:
        objective: what is made small, the error of the torque or that of the simulated velocity.
        form: how the acceleration enters a torque fit: by bumps (``weak``), or as the derivative of a filtered
            velocity (``derivative``).
        width: samples that a bump spans. Where it is not given: the widest of which 24 fit side by side if noise
            hides the sign of the velocity, else the narrowest whose standard errors are about the smallest.
        velocity: what a weak form evaluates friction at: the velocity as ``measured``; one that the fitted model
            ``explained``, in rounds; ``auto`` explains where the drive rests or noise could hide the sign of its
            velocity.
        rest: which samples count as rest: those ``detected`` by statistics, or those whose velocity is exactly ``zero``
            (simulated or gated by the sensor).
        preparation: filters of the derivative form.
        start: values that nonlinear parameters start from, by key, in place of their scans.
        samples: most samples of a simulation fit; a longer record is represented by pieces.
        max_seconds: of each of its four stages.
    """

    objective: Literal["torque", "simulation"] = "torque"
    form: Literal["weak", "derivative"] = "weak"
    width: int | None = Field(default=None, ge=8)
    velocity: Literal["auto", "measured", "explained"] = "auto"
    rest: Literal["detected", "zero"] = "detected"
    preparation: Preparation = Preparation(method="butterworth", decimate=10)
    start: dict[str, float] = Field(default_factory=dict)
    samples: int = Field(default=5000, ge=80)
    max_seconds: float = Field(default=20.0, gt=0.0)


class Batch(Estimator):
    r"""Least squares over the whole recording.

    The *torque* objective makes the error of :math:`J\dot\omega + \tau_F = \tau_m - \tau_L` small, in weak form,
    the linear parameters eliminated (variable projection). It bears a model that is not quite right. The *simulation*
    objective makes the error of the simulated velocity small; where the model is right and noise white, nothing is more
    precise, but an error of the model adds up over the record. Standard errors hold for autocorrelated residuals.
    """

    name = "batch"
    summary = "least squares over the whole recording: torque error (weak form) or simulation error"
    Settings = BatchSettings
    carries_states = True

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        """Estimate the free parameters; see :class:`BatchSettings` for the objectives."""
        started = time.perf_counter()
        if not np.any(recording.torque):
            raise EstimationError(f"recording '{recording.name}' has zero torque throughout; there is nothing to fit")
        check_start(drive, self.settings.start)
        if self.settings.form == "weak" or self.settings.objective == "simulation":
            recording = _complete(drive, recording)
        plan = Plan(start=self.settings.start)
        asked = self.settings.form == "weak" and self.settings.velocity != "measured"
        hidden = asked and _sign_is_hidden(recording)
        result = self._torque_fit(drive, recording, plan, self.settings.width, hidden=hidden)
        searched = searched_range(drive, recording)
        notes: dict[str, object]
        if self.settings.objective == "simulation":
            from estimators.batch.simulation_fit import simulation_fit

            refined = simulation_fit(drive, recording, result.values, self.settings.samples, self.settings.max_seconds)
            found, notes = refined.outcome, {"samples": refined.samples}
            notes["root_mean_square_velocity_error"] = refined.velocity_error
            reasons = not_identified(drive, found.values, found.covariance, found.undetermined, searched)
            reasons = {**lost_in_noise(self._noisy(drive, recording, found.values) if hidden else {}), **reasons}
        else:
            held: dict[str, str] = {}
            while True:
                found = result.outcome
                noisy = self._noisy(drive, recording, found.values) if hidden else {}
                reasons = not_identified(drive, found.values, result.conditional, found.undetermined, searched)
                reasons = {**lost_in_noise(noisy), **reasons, **held}
                doubtful = set(reasons) - set(held)
                choice = to_hold(drive, found.values, result.conditional, searched, doubtful, noisy)
                if choice is None or time.perf_counter() - started > self.settings.max_seconds:
                    break
                key, value = choice
                held[key] = f"{reasons[key]}; held at {value:.3g}"
                plan = replace(plan, held={**plan.held, key: value})
                result = self._torque_fit(drive, recording, plan, result.width, result, hidden=hidden)
            notes = {"samples_per_equation": result.width, "relative_error": result.relative_error}
        return self._report(drive, recording, found, reasons, notes, time.perf_counter() - started)

    def _torque_fit(
        self,
        drive: Drive,
        recording: Recording,
        plan: Plan,
        width: int | None,
        before: TorqueFit | None = None,
        *,
        hidden: bool,
    ) -> TorqueFit:
        """Fit the torque; ``before`` is the fit before a parameter was held, ``hidden``: is the sign lost in noise."""
        if self.settings.form == "derivative":
            return derivative_fit(drive, recording, self.settings.preparation, plan)
        choice = self.settings.velocity
        short_lived = bool(drive.model.states) or any(p.declared.periodic for p in drive.parameters)
        if width is None and hidden and not short_lived:
            width = possible_widths(recording)[-1]
        still = resting(recording) if self.settings.rest == "detected" else recording.velocity == 0.0
        start = before.solution.alpha if before is not None and drive.model.states else None
        result = weak_fit(drive, recording, width, still, recording.velocity, plan, start)
        if choice == "measured" or (choice == "auto" and not (hidden or still.any())):
            return result
        if before is not None and hidden:
            return self._sought(drive, recording, [result, before], plan, plan.held)
        result, settled = self._explained(drive, recording, result, plan, hidden=hidden)
        noisy = self._noisy(drive, recording, result.values) if hidden and not settled else {}
        if noisy and max(noisy.values()) > 0.0:
            noisiest = max(noisy, key=lambda key: noisy[key])
            again = self._sought(drive, recording, [result], plan, {noisiest: 0.0})
            result = min(result, again, key=lambda fit: prediction_error(drive, fit.values, recording))
        return result

    def _sought(
        self, drive: Drive, recording: Recording, fits: Sequence[TorqueFit], plan: Plan, held: Mapping[str, float]
    ) -> TorqueFit:
        """Fit again, in rounds, from the values that predict the velocity best while some are held."""
        values = sought(drive, [fit.values for fit in fits], recording, held)
        explained = explained_velocity(drive, dict(zip(drive.keys, values, strict=True)), recording)
        if explained is None:
            return fits[0]
        velocity, still, _ = explained
        result = weak_fit(drive, recording, fits[0].width, still, velocity, plan)
        return self._explained(drive, recording, result, plan, hidden=True)[0]

    def _explained(
        self, drive: Drive, recording: Recording, result: TorqueFit, plan: Plan, *, hidden: bool
    ) -> tuple[TorqueFit, bool]:
        """Explain the velocity by the fit and fit again, in rounds, while that does not predict the velocity worse.

        Returns:
            The fit, and whether the rounds settled.
        """
        best, least = result, np.inf
        for _ in range(MAX_ROUNDS):
            explained = explained_velocity(drive, dict(zip(drive.keys, result.values, strict=True)), recording)
            if explained is None:
                return result, True
            velocity, still, error = explained
            if error > WORSE * least:
                return best, False
            if error < least:
                best, least = result, error
            start = None if hidden and not drive.model.states else result.solution.alpha
            before, result = result, weak_fit(drive, recording, result.width, still, velocity, plan, start)
            spread = np.sqrt(np.clip(np.diag(result.covariance), 0.0, None))
            if np.all(np.abs(result.values - before.values) <= 0.1 * spread):
                return result, True
        return result, False

    def _noisy(self, drive: Drive, recording: Recording, values: Array) -> dict[str, float]:
        """Return key → share of noise in what each parameter multiplies; empty for a model with memory."""
        if drive.model.states:
            return {}
        named = dict(zip(drive.keys, values, strict=True))
        return drowned(drive, recording, {drive.inertia_key: drive.inertia or float("nan"), **named})

    def _report(
        self,
        drive: Drive,
        recording: Recording,
        found: Outcome,
        reasons: dict[str, str],
        notes: dict[str, object],
        seconds: float,
    ) -> Fit:
        parameters = dict(zip(drive.keys, (float(value) for value in found.values), strict=True))
        parameters.setdefault(drive.inertia_key, drive.inertia or float("nan"))
        return Fit(
            model=drive.model.name,
            estimator=self.name,
            dataset=recording.name,
            parameters=parameters,
            covariance=found.covariance,
            estimated=drive.keys,
            status=Status.OK if found.succeeded else Status.FAILED,
            message=found.message,
            not_identified=reasons,
            seconds=seconds,
            provenance={"settings": self.settings.model_dump(), "recording": recording.checksum, **notes},
        )


def _complete(drive: Drive, recording: Recording) -> Recording:
    """Return the recording with a velocity, and an acceleration where the model needs one."""
    lacking = "velocity" not in recording or ("acceleration" in drive.model.needs and "acceleration" not in recording)
    return prepare(recording) if lacking else recording


def _sign_is_hidden(recording: Recording) -> bool:
    """Return whether noise exceeds a tenth of what the velocity changes in a sampling interval (root mean square)."""
    changes = np.diff(recording.velocity)[np.diff(recording.run) == 0]
    usual = float(np.sqrt(np.mean(changes**2))) if len(changes) else 0.0
    return noise(recording.time, recording.velocity, recording.run) > 0.1 * usual
