"""Fits a whole model to the rows of a problem: linear parameters by bounded least squares, the others by search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.term import Effect
from fricmodels.weakform.candidate import is_instant
from fricmodels.weakform.optimise import coordinate_search
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.ranges import scan_size
from fricmodels.weakform.regression import cosine_terms, long_run_sum
from fricmodels.weakform.search import in_gap, search
from fricmodels.weakform.shifted import regression_of

Array = NDArray[np.float64]

_STAGES = 3
"""Fits in which the motor torque of a column is the one that the last fit explains, and the record at its delay."""


@dataclass(frozen=True)
class Estimate:
    """Parameters of a model by key, the inertia among them, with standard errors.

    Attributes:
        parameters, standard_errors: by key; what was given has no standard error.
        covariance: of what was estimated, in the order of :attr:`standard_errors`; ``None`` where only those are known.
    """

    parameters: Mapping[str, float]
    standard_errors: Mapping[str, float]
    covariance: Array | None = field(default=None, compare=False)


def estimate(
    drive: Drive, recording: Recording, start: Mapping[str, float] | None = None
) -> tuple[WeakFormProblem, Estimate]:
    """Fit a drive to a recording in weak form.

    Args:
        drive: model and inertia, ``None`` to estimate it.
        recording: with ``velocity``.
        start: values of nonlinear parameters to begin from; those not given are scanned.

    Returns:
        The rows, and the estimate.

    Raises:
        InputError: when the recording moves too little to fit the model.
    """
    start = _started(drive, recording, start or {})
    first = WeakFormProblem.of(drive, recording, _guess(drive, recording, start))
    found = _fit(first, start)
    # Once the friction is known, so is where the drive may stick at a reversal.
    problem = WeakFormProblem.of(drive, recording, found.parameters)
    found = _fit(problem, {**start, **found.parameters})
    if drive.model.delay or "motor_torque" in drive.model.needs:
        for _ in range(_STAGES):
            if drive.model.delay:
                problem = WeakFormProblem.of(drive, recording, found.parameters)
            problem = replace(problem, estimated=found.parameters)
            found = _fit(problem, {**start, **found.parameters})
    if drive.model.states or drive.model.delay:
        # A memory or a delay has most to say where it is not certain how the drive moved; that may mislead it, too.
        other = _fit(problem.including_uncertain_motion, {**start, **found.parameters})
        found = min(found, other, key=lambda e: _left(drive, recording, e.parameters))
    return replace(
        problem, friction_limits=problem.limits_of_friction(found.parameters), estimated=found.parameters
    ), found


def _left(drive: Drive, recording: Recording, parameters: Mapping[str, float]) -> float:
    """Return the sum of squares that a model leaves over all of a recording."""
    error = filtered_torque_error(drive, parameters, recording, sliding_half_width(recording))
    return float(error @ error)


def _started(drive: Drive, recording: Recording, start: Mapping[str, float]) -> Mapping[str, float]:
    """Return where to begin: what is not given of an effect is searched for in what the model without it leaves over.

    A wave number, a delay or an instant must be near the truth for a fit of the whole model to find it.
    """
    keys = {p.key for p in drive.model_parameters if (not p.linear or p.declared.delay) and p.key not in start}
    for effect in reversed(drive.model.effects):
        wanted = [p.symbol for p in effect.parameters if f"{effect.name}.{p.symbol}" in keys]
        if not wanted:
            continue
        smaller = Drive(drive.model.minus(effect.name), drive.inertia, drive.motion)
        problem, rest = estimate(smaller, recording, start)
        found = search(problem, regression_of(problem, rest.parameters), effect, problem.alone(effect))
        if found is None:
            return start
        nonlinear = [p.symbol for p in effect.parameters if not _linear_in(drive, effect, p.symbol)]
        values = {f"{effect.name}.{s}": value for s, value in zip(nonlinear, found.nonlinear, strict=True)}
        values |= {f"{effect.name}.{p.symbol}": found.delay for p in effect.parameters if p.delay}
        return {**rest.parameters, **values, **start}
    return start


def _linear_in(drive: Drive, effect: Effect, symbol: str) -> bool:
    return next(p.linear for p in drive.model_parameters if p.key == f"{effect.name}.{symbol}")


def _guess(drive: Drive, recording: Recording, start: Mapping[str, float]) -> dict[str, float]:
    """Return parameters good enough to choose the width of the bumps: only the inertia matters."""
    values = {p.key: start.get(p.key, p.declared.initial) for p in drive.model.parameters}
    if drive.inertia is None:
        acceleration = np.gradient(recording.velocity, recording.time)
        coarse = np.convolve(acceleration, np.ones(9) / 9, "same")
        force = np.convolve(recording.torque - recording.load_torque, np.ones(9) / 9, "same")
        base = np.column_stack([coarse, np.sign(recording.velocity), recording.velocity])
        values[drive.inertia_key] = max(float(np.linalg.lstsq(base, force, rcond=None)[0][0]), 1e-12)
    return values


def _fit(problem: WeakFormProblem, start: Mapping[str, float]) -> Estimate:
    drive, model = problem.drive, problem.drive.model
    if problem.rows <= 4 * len(drive.parameters):
        raise InputError(
            f"recording '{problem.recording.name}' moves too little: {problem.rows} stretches of clear motion for "
            f"{len(drive.parameters)} parameters; record longer, faster, or with less noise"
        )
    nonlinear = [p for p, is_linear in zip(model.parameters, model.linear, strict=True) if not is_linear]
    declared = [p.declared for p in nonlinear]

    def at(point: tuple[float, ...]) -> tuple[float, Array]:
        return _linear(problem, point)

    point: list[float] = []
    ratios = []
    for p in nonlinear:
        size = scan_size(problem.recording, p.declared)
        scan = [value * size for value in p.declared.scan] or [p.declared.initial]
        point.append(start.get(p.key, scan[len(scan) // 2]))
        ratios.append(1.02 if p.declared.periodic else (1.3 if p.key in start else 2.0))
    for i, p in enumerate(nonlinear):
        if p.key not in start and p.declared.scan:
            size = scan_size(problem.recording, p.declared)
            choices: list[tuple[float, ...]] = [
                (*point[:i], value * size, *point[i + 1 :]) for value in p.declared.scan
            ]
            costs = [at(choice)[0] for choice in choices]
            point = list(choices[int(np.argmin(costs))])
    bounds = [(p.lower, p.upper) for p in declared]
    best = coordinate_search(lambda values: -at(values)[0], tuple(point), bounds, ratios) if point else ()
    time, resolution = np.sort(problem.recording.time), problem.bumps.width * problem.recording.interval
    best = tuple(
        in_gap(value, time, resolution) if is_instant(p) else value for value, p in zip(best, declared, strict=True)
    )
    _, theta = at(best)
    values = _named(problem, theta, best)
    keys, covariance = _covariance(problem, values)
    errors = dict(zip(keys, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    return Estimate(values, errors, covariance)


def _stack(problem: WeakFormProblem, nonlinear: tuple[float, ...]) -> tuple[Array, Array]:
    """Return the columns (inertia first where it is free, model, nuisances) and the target."""
    columns, offset = problem.columns(problem.drive, nonlinear)
    stacked = [problem.momentum[None]] if problem.drive.inertia is None else []
    stacked += [columns, problem.sign_change[None]]
    if "motor_torque_rate" not in problem.drive.model.needs:
        stacked.append(problem.torque_rate[None])
    return np.vstack(stacked), problem.target - offset


def _linear(problem: WeakFormProblem, nonlinear: tuple[float, ...]) -> tuple[float, Array]:
    from scipy.optimize import lsq_linear

    columns, target = _stack(problem, nonlinear)
    linear = [p.declared for p in problem.drive.parameters if p.linear]
    spare = len(columns) - len(linear)
    delay = problem.recording.interval
    passed = [problem.delay if p.delay else 0.0 for p in linear]
    limits = [(p.lower - gone, p.upper - gone) for p, gone in zip(linear, passed, strict=True)]
    limits += [(-np.inf, np.inf), (-delay, delay)][:spare]
    size = np.linalg.norm(columns, axis=1)
    size = np.where(size > 0, size, 1.0)
    lower, upper = (np.array(side) * size for side in zip(*limits, strict=True))
    q, r = np.linalg.qr((columns / size[:, None]).T)
    solved = lsq_linear(r + 1e-12 * np.eye(len(r)), q.T @ target, bounds=(lower, upper), method="bvls")
    residual = target - (solved.x / size) @ columns
    return float(residual @ residual), solved.x / size


def _named(problem: WeakFormProblem, theta: Array, nonlinear: tuple[float, ...]) -> dict[str, float]:
    drive = problem.drive
    values: dict[str, float] = {}
    linear, other = iter(theta), iter(nonlinear)
    for p in drive.parameters:
        values[p.key] = float(next(linear) if p.linear else next(other))
        if p.declared.delay:
            values[p.key] += problem.delay
    values.setdefault(drive.inertia_key, drive.inertia or float("nan"))
    return values


def _covariance(problem: WeakFormProblem, values: Mapping[str, float]) -> tuple[list[str], Array]:
    """Return the estimated keys and their covariance from the long-run variance of the scores; 0 if not determined."""
    drive = problem.drive
    base = problem.base(values)
    linear = [p.key for p in drive.model_parameters if p.linear]
    other = [p.key for p in drive.model_parameters if not p.linear]
    keys = [*linear, *other, *([drive.inertia_key] if drive.inertia is None else [])]
    nuisances = [problem.sign_change] if drive.model.delay else [problem.sign_change, problem.torque_rate]
    columns = np.vstack([base, *nuisances])
    size = np.linalg.norm(columns, axis=1)
    unit = columns / np.where(size > 0, size, 1.0)[:, None]
    inverse = np.linalg.pinv(unit @ unit.T, rcond=1e-10, hermitian=True)
    residual = problem.target - (inverse @ (unit @ problem.target)) @ unit
    meat = long_run_sum(unit * residual, cosine_terms(problem.independent, problem.rows))
    scale = 1.0 / np.where(size > 0, size, 1.0)
    covariance = (inverse @ meat @ inverse * np.outer(scale, scale))[: len(keys), : len(keys)]
    covariance[np.diag_indices(len(keys))] = np.clip(np.diag(covariance), 0, None)
    return keys, np.asarray(covariance)
