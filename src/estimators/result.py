"""From a filter's trajectory to a fit: final values, honest standard errors, status, provenance."""

from __future__ import annotations

import time
from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.regression import long_run_covariance
from estimators.sequential import FilterProblem, Trajectory
from fricmodels.drive import Drive
from fricmodels.estimator import Estimator
from fricmodels.fit import Fit, Status
from fricmodels.recording import Recording

Array = NDArray[np.float64]


def provenance(estimator: Estimator, recording: Recording) -> dict[str, Any]:
    """Return what a fit came from."""
    return {
        "settings": estimator.settings.model_dump(mode="json"),
        "recording": recording.checksum,
        "versions": {"casadi": version("casadi"), "numba": version("numba"), "filterpy": version("filterpy")},
    }


def failed_fit(
    estimator: Estimator,
    drive: Drive,
    recording: Recording,
    began: float,
    status: Status,
    message: str,
    values: Mapping[str, float] | None = None,
    **extra: Any,
) -> Fit:
    """Return a fit that says what went wrong; its parameters are NaN where none are given."""
    keys = drive.keys
    given = {drive.inertia_key: drive.inertia} if drive.inertia is not None else {}
    parameters = {**given, **dict.fromkeys(keys, float("nan")), **(values or {})}
    return Fit(
        model=drive.model.name,
        estimator=estimator.name,
        dataset=recording.name,
        parameters=parameters,
        covariance=np.full((len(keys), len(keys)), np.nan),
        estimated=keys,
        status=status,
        message=message,
        seconds=time.perf_counter() - began,
        provenance=provenance(estimator, recording),
        **extra,
    )


def diverged_fit(
    estimator: Estimator, problem: FilterProblem, recording: Recording, trajectory: Trajectory, began: float
) -> Fit:
    """Return the fit of a filter that overflowed: it says at which sample."""
    at = trajectory.diverged_at or 0
    message = f"the estimate stopped being finite at sample {at} (time {recording.time[at]:.6g} s)"
    return failed_fit(
        estimator, problem.drive, recording, began, Status.DIVERGED, message, history=problem.history(trajectory)
    )


def averaged_fit(
    estimator: Estimator,
    problem: FilterProblem,
    recording: Recording,
    trajectory: Trajectory,
    share: float,
    model_weight: float,
    began: float,
) -> Fit:
    """Return the mean over the last whole cycles, with standard errors from its slow variation.

    One cycle is the period of the normalisation, 2π of normalised time. The filter remembers for a few cycles, so the
    variance of the mean is taken from the variation at periods of four cycles and more (equal-weighted cosines, half
    as many as cycles). With fewer than three cycles the mean over what there is, or the final value, is reported with
    the filter's own P, scaled to the measured innovations.
    """
    if trajectory.diverged_at is not None:
        return diverged_fit(estimator, problem, recording, trajectory, began)
    normalised = trajectory.states[:, problem.moving :]
    elapsed = _elapsed(recording) / problem.scales.time / (2 * np.pi)
    cycles = int(np.floor(elapsed[-1] * share + 1e-6))
    message = ""
    if cycles >= 3:
        last = normalised[elapsed > elapsed[-1] - cycles + 1e-6]
        estimate = last.mean(axis=0)
        waves = max(2, cycles // 2)
        covariance = long_run_covariance(last - estimate, waves) / len(last) ** 2
    else:
        estimate = normalised[-1] if cycles < 1 else normalised[elapsed > elapsed[-1] - cycles + 1e-6].mean(axis=0)
        ratio = np.nanmean(trajectory.innovation**2 / trajectory.innovation_variance)
        covariance = np.diag(trajectory.variances[-1, problem.moving :]) * float(ratio)
        message = "fewer than three cycles to average: standard errors from the filter's own covariance"
    size = problem.drive.parameter_scales(problem.scales)
    walked = model_weight * float(elapsed[-1]) * 2 * np.pi
    return Fit(
        model=problem.drive.model.name,
        estimator=estimator.name,
        dataset=recording.name,
        parameters=problem.named(estimate * size),
        covariance=covariance * np.outer(size, size),
        estimated=problem.drive.keys,
        message=message,
        not_identified=unidentified(problem, trajectory.variances[-1, problem.moving :], walked),
        history=problem.history(trajectory),
        seconds=time.perf_counter() - began,
        provenance=provenance(estimator, recording),
    )


def _elapsed(recording: Recording) -> Array:
    """Return the time spent within runs up to each sample [s]."""
    steps = np.where(np.diff(recording.run) == 0, np.diff(recording.time), 0.0)
    return np.concatenate([[0.0], np.cumsum(steps)])


def unidentified(problem: FilterProblem, variances: Array, walked: float = 0.0) -> dict[str, str]:
    """Name the parameters whose variance the recording left above half of what it would be without it.

    That is the initial one, plus what a random walk (eq. 14 adds the unit matrix) has ``walked``.
    """
    before = np.diag(problem.initial_covariance)[problem.moving :] + walked
    return {
        key: "the recording reduces its variance by less than half"
        for key, after, first in zip(problem.drive.keys, variances, before, strict=True)
        if after > 0.5 * first
    }
