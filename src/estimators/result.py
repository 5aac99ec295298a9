"""From a filter's trajectory to a fit: final values, honest standard errors, status, provenance."""

from __future__ import annotations

import time
from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.regression import long_run_variance
from estimators.sequential import FilterProblem, Trajectory, unpack
from fricmodels.dimension import VELOCITY
from fricmodels.drive import Drive
from fricmodels.estimator import Estimator
from fricmodels.fit import Fit, Status
from fricmodels.recording import Recording

Array = NDArray[np.float64]

_PERTURBED = 24


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
    estimator: Estimator,
    problem: FilterProblem,
    recording: Recording,
    trajectory: Trajectory,
    began: float,
    what: str = "the estimate stopped being finite",
) -> Fit:
    """Return the fit of a filter that overflowed: it says at which sample."""
    at = trajectory.diverged_at or 0
    message = f"{what} at sample {at} (time {recording.time[at]:.6g} s)"
    return failed_fit(
        estimator, problem.drive, recording, began, Status.DIVERGED, message, history=problem.history(trajectory)
    )


def filtered_fit(
    estimator: Estimator,
    problem: FilterProblem,
    recording: Recording,
    trajectory: Trajectory,
    began: float,
    **came_from: Any,
) -> Fit:
    """Return the last estimate of a filter with its own covariance, widened by :func:`inflation`.

    Args:
        estimator, problem, recording, trajectory: what was filtered, by what.
        began: when, by ``time.perf_counter()``.
        came_from: what the provenance says besides.
    """
    moving, size = problem.moving, problem.drive.parameter_scales(problem.scales)
    x, covariance = trajectory.memory[: problem.order], unpack(trajectory.memory[problem.order :], problem.order)
    return Fit(
        model=problem.drive.model.name,
        estimator=estimator.name,
        dataset=recording.name,
        parameters=problem.named(problem.parameters(x)),
        covariance=covariance[moving:, moving:] * np.outer(size, size) * inflation(trajectory),
        estimated=problem.drive.keys,
        not_identified=unidentified(problem, np.diag(covariance)[moving:]),
        history=problem.history(trajectory),
        seconds=time.perf_counter() - began,
        provenance=provenance(estimator, recording) | came_from,
    )


def inflation(trajectory: Trajectory) -> float:
    """Return by how much the covariance must grow for innovations that are not white or larger than believed.

    The long-run variance of the normalised innovations over the second half, by equal-weighted cosines; at least 1.
    """
    normalised = trajectory.innovation / np.sqrt(trajectory.innovation_variance)
    late = normalised[len(normalised) // 2 :]
    late = late[np.isfinite(late)]
    return max(1.0, float(np.mean(late**2)), long_run_variance(late))


def averaged_fit(
    estimator: Estimator,
    problem: FilterProblem,
    recording: Recording,
    trajectory: Trajectory,
    share: float,
    model_weight: float,
    began: float,
    seed: int,
) -> Fit:
    """Return the mean over the last whole cycles, with standard errors from filtering perturbed recordings.

    One cycle is the period of the normalisation, 2π of normalised time; with less than one in the share that is to be
    averaged, the final value is taken. White noise as strong as the innovations of the second half, or stronger where
    they are alike from sample to sample, is added to the velocity and the recording filtered again, 24 times: the
    covariance of these estimates is that of the one reported.
    """
    if trajectory.diverged_at is not None:
        return diverged_fit(estimator, problem, recording, trajectory, began)
    elapsed = _elapsed(recording) / problem.scales.time / (2 * np.pi)
    cycles = int(np.floor(elapsed[-1] * share + 1e-6))
    last = elapsed > elapsed[-1] - cycles + 1e-6 if cycles else elapsed >= elapsed[-1]
    estimate = trajectory.states[last, problem.moving :].mean(axis=0)
    innovation = trajectory.innovation[len(last) // 2 :]
    innovation = innovation[np.isfinite(innovation)]
    strength = np.sqrt(max(float(np.mean(innovation**2)), long_run_variance(innovation)))
    noise = np.random.default_rng(seed)
    others = []
    for _ in range(_PERTURBED):
        added = strength * problem.scales.of(VELOCITY) * noise.standard_normal(len(recording))
        again = problem.run(recording.with_channels(velocity=recording.velocity + added))
        others.append(again.states[last, problem.moving :].mean(axis=0))
    covariance = np.atleast_2d(np.cov(np.array(others).T))
    size = problem.drive.parameter_scales(problem.scales)
    walked = model_weight * float(elapsed[-1]) * 2 * np.pi
    return Fit(
        model=problem.drive.model.name,
        estimator=estimator.name,
        dataset=recording.name,
        parameters=problem.named(estimate * size),
        covariance=covariance * np.outer(size, size),
        estimated=problem.drive.keys,
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
