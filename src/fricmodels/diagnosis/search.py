"""Finds the nonlinear parameters of a candidate effect: delays, widths, wave numbers, instants."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.evidence import Regression
from fricmodels.diagnosis.problem import Problem
from fricmodels.dimension import TIME, Dimension
from fricmodels.drive import Drive
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.term import Effect

Array = NDArray[np.float64]

_PEAKS = 12
_ROUNDS = 7
_LEAST_PERIODS = 1.5
"""A period is told from slower shapes once the positions cover it one and a half times."""


@dataclass(frozen=True)
class Found:
    """The best values found for an effect's nonlinear parameters.

    Attributes:
        nonlinear: their values, in order.
        columns: the effect's linear columns there that count, shape (q, rows).
        kept: which of the linear parameters these are; the others are zero.
        explained: sum of squares that they explain beyond the base model.
        trials: about how many independent values were tried; it multiplies the p-value.
    """

    nonlinear: tuple[float, ...]
    columns: Array
    kept: NDArray[np.bool_]
    explained: float
    trials: float


def natural_size(recording: Recording, dimension: Dimension) -> float:
    """Return the recording's own size of a quantity: peak velocity, position range, duration, RMS torque."""
    peak = float(np.max(np.abs(recording.velocity)))
    duration = float(np.ptp(recording.time))
    force = float(np.sqrt(np.mean(recording.torque**2)))
    length = float(np.ptp(recording["position"])) if "position" in recording else peak * duration
    size = force ** float(dimension.force)
    if dimension.displacement == -dimension.time:
        return float(size * peak ** float(dimension.displacement))
    return float(size * length ** float(dimension.displacement) * duration ** float(dimension.time))


def search(problem: Problem, regression: Regression, effect: Effect, alone: Drive) -> Found | None:
    """Return the best nonlinear parameters of an effect, or ``None`` where none makes it visible."""
    linear = [p for p, is_linear in zip(effect.parameters, alone.model.linear, strict=True) if is_linear]
    nonlinear = [p for p, is_linear in zip(effect.parameters, alone.model.linear, strict=True) if not is_linear]
    lower = np.array([p.lower for p in linear])
    upper = np.array([problem.law_slope if p.part_of_law else p.upper for p in linear])

    def at(point: tuple[float, ...], trials: float = 1.0) -> Found:
        columns, _ = problem.columns(alone, point)
        gained, theta = regression.explained(columns, lower, upper)
        kept = theta != 0
        return Found(point, columns[kept], kept, gained, trials)

    if not nonlinear:
        found = at(())
        return found if np.any(found.kept) or np.any(regression.visible(problem.columns(alone)[0])) else None
    points, spacing, trials = _starts(problem, regression, alone, nonlinear)
    if not points:
        return None
    best = max((at(point, trials) for point in points), key=lambda found: found.explained)
    if best.explained <= 0:
        return best if np.any(regression.visible(problem.columns(alone, best.nonlinear)[0])) else None
    return _refine(at, best, nonlinear, spacing)


def _starts(
    problem: Problem, regression: Regression, alone: Drive, nonlinear: list[Parameter]
) -> tuple[list[tuple[float, ...]], list[float], float]:
    """Return starting points, the spacing of each parameter (a ratio if above 1, else a step), and the trials."""
    choices: list[list[float]] = []
    spacing: list[float] = []
    trials = 1.0
    for parameter in nonlinear:
        if parameter.periodic:
            values, step, tried = wave_numbers(problem, regression, alone, parameter.lower)
            choices.append(values)
            spacing.append(-step)
            trials *= tried
            continue
        size = natural_size(problem.recording, parameter.dimension)
        scan = [value * size for value in parameter.scan] or [parameter.initial]
        choices.append(scan)
        trials *= len(scan)
        ratio = scan[1] / scan[0] if len(scan) > 1 and scan[0] > 0 else 2.0
        is_instant = parameter.dimension == TIME and parameter.lower < 0
        spacing.append(-(scan[1] - scan[0]) if is_instant and len(scan) > 1 else ratio)
    return [tuple(point) for point in itertools.product(*choices)], spacing, trials


def _refine(
    at: Callable[[tuple[float, ...], float], Found], best: Found, nonlinear: list[Parameter], spacing: list[float]
) -> Found:
    point = walk(lambda values: at(values, best.trials).explained, best.nonlinear, nonlinear, spacing)
    return at(point, best.trials)


def walk(
    value: Callable[[tuple[float, ...]], float],
    point: tuple[float, ...],
    parameters: Sequence[Parameter],
    spacing: Sequence[float],
) -> tuple[float, ...]:
    """Climb from a point, each parameter in turn, by steps that halve each round.

    Args:
        value: what is to be made large.
        point: where to begin.
        parameters: with their bounds.
        spacing: first step of each parameter: a ratio if positive, a difference if negative.
    """
    steps = list(spacing)
    best = value(point)
    for _ in range(_ROUNDS):
        for i, parameter in enumerate(parameters):
            for direction in (-1, 1):
                here, step = point[i], steps[i]
                moved = here - direction * step / 2 if step < 0 else here * step ** (direction / 2)
                moved = float(np.clip(moved, parameter.lower, parameter.upper))
                if moved == here:
                    continue
                trial = (*point[:i], moved, *point[i + 1 :])
                reached = value(trial)
                if reached > best:
                    point, best = trial, reached
                    break
        steps = [step / 2 if step < 0 else step**0.5 for step in steps]
    return point


def wave_numbers(
    problem: Problem, regression: Regression, alone: Drive, least: float = 0.0
) -> tuple[list[float], float, float]:
    """Return the wave numbers at which the residual is most periodic in position, strongest first.

    The residual, multiplied by what the effect's torque is in proportion to (its column at wave number 0), is summed
    over bins of position; the Fourier transform over position then shows every wave number at once.

    Returns:
        Wave numbers [1/rad or 1/m], their resolution, and how many independent ones were looked at.
    """
    recording = problem.recording
    position = recording["position"]
    low, high = float(np.min(position)), float(np.max(position))
    span = high - low
    travel = np.abs(problem.smooth) * recording.interval
    moving = ~problem.resting & (travel > 0)
    if span <= 0 or not np.any(moving):
        return [], 1.0, 1.0
    # Half of the time a bump must pass less than a quarter period, or it averages the effect away.
    fastest = 2 * np.pi / (4 * float(np.percentile(travel[moving], 20)) * problem.bumps.width / 4)
    slowest = max(_LEAST_PERIODS * 2 * np.pi / span, least)
    if fastest <= slowest:
        return [], 1.0, 1.0
    design, _ = problem.evaluate(alone, [0.0] * sum(not flag for flag in alone.model.linear))
    amplitude = design[0, : len(recording)]
    sampled = np.interp(np.arange(len(recording)), problem.centre, regression.residual)
    sampled = np.where(moving, sampled * amplitude, 0.0)
    bins = int(min(2**15, max(64, 2 ** np.ceil(np.log2(4 * fastest * span / (2 * np.pi))))))
    place = np.minimum(((position - low) / span * bins).astype(np.int64), bins - 1)
    summed = np.bincount(place, weights=sampled, minlength=bins)
    padded = 4 * bins
    power = np.abs(np.fft.rfft(summed, padded)) ** 2
    k = 2 * np.pi * np.arange(len(power)) / (span * padded / bins)
    inside = (k >= slowest) & (k <= min(fastest, k[-1]))
    peaks = np.flatnonzero(inside[1:-1] & (power[1:-1] >= power[:-2]) & (power[1:-1] >= power[2:])) + 1
    edges = np.flatnonzero(inside)[[0, -1]] if np.any(inside) else np.array([], dtype=int)
    peaks = np.unique(np.concatenate([peaks, edges]))
    strongest = peaks[np.argsort(power[peaks])[::-1][:_PEAKS]]
    trials = max(1.0, float((min(fastest, k[-1]) - slowest) * span / np.pi))
    return [float(k[i]) for i in strongest], float(np.pi / span), trials
