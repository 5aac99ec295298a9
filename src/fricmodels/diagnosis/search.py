"""Finds the nonlinear parameters of a candidate effect: delays, widths, wave numbers, instants."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fricmodels.ascent import simplexes, walk
from fricmodels.diagnosis.evidence import Regression
from fricmodels.diagnosis.problem import Problem
from fricmodels.dimension import DIMENSIONLESS, DISPLACEMENT, TIME
from fricmodels.drive import Drive
from fricmodels.parameter import Parameter
from fricmodels.recording import natural_size
from fricmodels.signals.order_spectrum import WaveNumbers, wave_numbers
from fricmodels.term import Effect

Array = NDArray[np.float64]

_SHIFTS = (1, 2, 3, 5, 8, 12, 18, 27, 40)
"""Delays that are tried first, in samples."""
_FARTHEST = 5.0
"""How far beyond the largest and the smallest that is tried first a parameter may go."""
_STARTS, _FEW = 4, 2
"""Where there is more than one nonlinear parameter there may be several summits: so many starts are tried. More than a
few are sought together."""
_HOPELESS, _NEAR = 0.05, 0.5
"""What explains less than this share of the residual, or of what another effect explains, is sought no further."""
_END = 1.001
"""Within a thousandth of a bound a parameter is at its end."""
_UNLIKELY = 0.25
"""Nor is what explains less than this share of that from its best start."""
_SIGNED = 0.2
"""Spacing of a parameter of either sign of which only one value is tried first."""


@dataclass(frozen=True)
class Found:
    """The best values found for an effect's nonlinear parameters.

    Attributes:
        nonlinear: their values, in order.
        columns: the effect's linear columns there that count, shape (q, rows).
        kept: which of the linear parameters these are; the others are zero.
        explained: sum of squares that they explain beyond the base model.
        trials: about how many independent values were tried; it multiplies the p-value.
        delay: the effect's delay [s], where one of its linear parameters is such; its column holds the whole shift.
        stretched: whether an effect that remembers the motion explains most at the end of what this recording can tell.
    """

    nonlinear: tuple[float, ...]
    columns: Array
    kept: NDArray[np.bool_]
    explained: float
    trials: float
    delay: float = 0.0
    stretched: bool = False


def search(problem: Problem, regression: Regression, effect: Effect, alone: Drive, rival: float = 0.0) -> Found | None:
    """Return the best nonlinear parameters of an effect, or ``None`` where none makes it visible.

    Args:
        problem, regression: the rows.
        effect: the candidate.
        alone: a drive with nothing but the effect.
        rival: sum of squares that another effect explains. What does not come near it is sought no further.
    """
    if alone.model.delay:
        regression = regression.unshifted
    linear = [p for p, is_linear in zip(effect.parameters, alone.model.linear, strict=True) if is_linear]
    nonlinear = [p for p, is_linear in zip(effect.parameters, alone.model.linear, strict=True) if not is_linear]
    nonlinear = [_within_recording(problem, p) for p in nonlinear]
    lower = np.array([p.lower for p in linear])
    delay = _delay(problem, regression, alone) if alone.model.delay and not nonlinear else 0.0
    bounded = np.array([problem.most(p) for p in linear])
    takes_part = type(effect).own_friction is not Effect.own_friction
    peak = float(np.max(np.abs(problem.recording.velocity)))

    def upper(point: tuple[float, ...]) -> Array:
        """Return the most of each linear parameter: its part of the drive has no more friction than all of it."""
        if not takes_part:
            return bounded
        given = {p.symbol: x for p, x in zip(nonlinear, point, strict=True)} | {p.symbol: 0.0 for p in linear}
        each = np.array([effect.own_friction(peak, given | {p.symbol: 1.0}) for p in linear])
        return np.asarray(np.minimum(bounded, problem.law_share[1] / np.maximum(each, 1e-300)))

    def at(point: tuple[float, ...], trials: float = 1.0) -> Found:
        columns, _ = problem.columns(alone, point, delay)
        gained, theta = regression.explained(columns, lower, upper(point))
        kept = theta != 0
        return Found(point, columns[kept], kept, gained, trials, delay)

    @cache
    def value(point: tuple[float, ...]) -> float:
        return regression.explained(problem.columns(alone, point, delay)[0], lower, upper(point))[0]

    if not nonlinear:
        found = at((), 2.0 * len(_SHIFTS) if delay else 1.0)
        return found if np.any(found.kept) or np.any(regression.visible(problem.columns(alone)[0])) else None
    points, spacing, trials, nonlinear = starting_points(problem, regression, alone, nonlinear)
    if not points:
        return None
    starts = sorted(points, key=value, reverse=True)
    first = starts[0]
    if value(first) <= 0:
        return at(first, trials) if np.any(regression.visible(problem.columns(alone, first)[0])) else None
    bounds = [(p.lower, p.upper) for p in nonlinear]

    def reached(point: tuple[float, ...]) -> Found:
        ended = any(
            step != 1.0 and not p.lower * _END < x < p.upper / _END
            for p, x, step in zip(nonlinear, point, spacing, strict=True)
            if not p.secondary and p.dimension != DIMENSIONLESS
        )
        return replace(at(point, trials), stretched=bool(effect.states) and ended)

    worth = max(_HOPELESS * float(regression.residual @ regression.residual), _NEAR * rival)
    if len(nonlinear) > _FEW:
        return reached(simplexes(value, starts, bounds, spacing, worth))
    best = walk(value, first, bounds, spacing)
    more = starts[1:_STARTS] if len(nonlinear) > 1 and value(best) >= _UNLIKELY * worth else ()
    return reached(max((best, *(walk(value, start, bounds, spacing) for start in more)), key=value))


def _within_recording(problem: Problem, parameter: Parameter) -> Parameter:
    """Return a parameter with the bounds that a recording sets: sizes of which it can tell.

    None is much larger or smaller than what is tried first: a load whose friction stops it a million times sooner than
    the drive ever stops is another effect in disguise, and so is a stiction that rises between two samples. A length is
    no more than the travel, since a longer one was never crossed.
    """
    dimension, scan = parameter.dimension, parameter.scan
    if dimension == DIMENSIONLESS or parameter.periodic or is_instant(parameter):
        return parameter
    size = natural_size(problem.recording, dimension)
    lower, upper = parameter.lower, parameter.upper
    if scan and min(scan) > 0:
        lower, upper = max(lower, size * min(scan) / _FARTHEST), min(upper, size * _FARTHEST * max(scan))
    if dimension == DISPLACEMENT:
        upper = min(upper, size)
    return replace(parameter, initial=min(max(parameter.initial, lower), upper), lower=lower, upper=upper)


def _delay(problem: Problem, regression: Regression, alone: Drive) -> float:
    """Return the delay [s] that, as a whole shift in time, explains most of the residual: the best of a few, refined.

    It is at least the sampling interval; a shorter one is how recordings are made, see :mod:`.shifted`.
    """
    from scipy.optimize import minimize_scalar

    interval = problem.recording.interval

    def left(samples: float) -> float:
        delay = samples * interval
        columns, _ = problem.columns(alone, delay=delay)
        rest = regression.residual - delay * regression.free(columns)[0]
        return float(rest @ rest)

    side = min((1, -1), key=lambda side: min(left(side * samples) for samples in _SHIFTS))
    best = min(range(len(_SHIFTS)), key=lambda i: left(side * _SHIFTS[i]))
    ends = side * _SHIFTS[max(best - 1, 0)], side * _SHIFTS[min(best + 1, len(_SHIFTS) - 1)]
    refined = minimize_scalar(left, bounds=sorted(ends), method="bounded", options={"xatol": 0.01})
    return float(refined.x) * interval


def starting_points(
    problem: Problem, regression: Regression, alone: Drive, nonlinear: list[Parameter]
) -> tuple[list[tuple[float, ...]], list[float], float, list[Parameter]]:
    """Return starting points, the spacing of each parameter (a ratio if positive, else a difference, as of
    :func:`fricmodels.ascent.simplexes`), and the trials.

    The parameters come back with the bounds that this recording sets: a period must be passed as a whole.
    """
    choices: list[list[float]] = []
    spacing: list[float] = []
    bounded: list[Parameter] = []
    trials = 1.0
    for parameter in nonlinear:
        if parameter.periodic:
            waves = _wave_numbers(problem, regression, alone, parameter.lower)
            choices.append(list(waves.strongest))
            spacing.append(-waves.resolution)
            trials *= waves.independent
            lower = max(parameter.lower, 2 * waves.resolution)
            bounded.append(replace(parameter, lower=lower, initial=max(parameter.initial, lower)))
            continue
        bounded.append(parameter)
        size = natural_size(problem.recording, parameter.dimension)
        scan = [value * size for value in parameter.scan] or [parameter.initial]
        choices.append(scan)
        trials *= len(scan)
        if parameter.lower < 0 or scan[0] <= 0:
            spacing.append(-(scan[1] - scan[0]) if len(scan) > 1 else -_SIGNED * size)
        else:
            spacing.append(scan[1] / scan[0] if len(scan) > 1 else 2.0)
    for i in _idle(problem, alone, choices):
        trials /= len(choices[i])
        choices[i], spacing[i] = choices[i][:1], 1.0
    return [tuple(point) for point in itertools.product(*choices)], spacing, trials, bounded


def _idle(problem: Problem, alone: Drive, choices: list[list[float]]) -> list[int]:
    """Return which parameters make no difference on this recording, such as one of a load without load."""
    if not all(choices):
        return []
    middle = [values[len(values) // 2] for values in choices]
    idle = []
    for i, values in enumerate(choices):
        if len(values) > 2:
            ends = values[0], values[-1]
            first, last = (problem.columns(alone, [*middle[:i], end, *middle[i + 1 :]])[0] for end in ends)
            if np.any(first) and np.array_equal(first, last):
                idle.append(i)
    return idle


def is_instant(parameter: Parameter) -> bool:
    """Whether a parameter is a point in time, not a duration."""
    return parameter.dimension == TIME and parameter.lower < 0


def in_gap(instant: float, time: Array, resolution: float) -> float:
    """Return the middle of the gap, longer than the resolution, that an instant lies in or next to; else the instant.

    Nothing was recorded within a gap, or what was is kept back, so that nothing tells where in it something happened.
    """
    before = np.flatnonzero(np.diff(time) > resolution)
    near = before[(time[before] - resolution < instant) & (instant < time[before + 1] + resolution)]
    return float(0.5 * (time[near[0]] + time[near[0] + 1])) if len(near) else instant


def _wave_numbers(problem: Problem, regression: Regression, alone: Drive, least: float) -> WaveNumbers:
    """Return the wave numbers at which the residual is most periodic in position.

    The residual is multiplied by what the effect's torque is in proportion to: its column at wave number 0.
    """
    design, _ = problem.evaluate(alone, [0.0] * sum(not flag for flag in alone.model.linear))
    return periods(problem, regression, design[0, : len(problem.recording)], least)


def periods(problem: Problem, regression: Regression, factor: Array, least: float) -> WaveNumbers:
    """Return the wave numbers at which the residual times ``factor``, shape (N,), is most periodic in position."""
    recording = problem.recording
    travel = np.abs(problem.smooth) * recording.interval
    moving = ~problem.resting & (travel > 0)
    if not np.any(moving):
        return WaveNumbers((), 1.0, 1.0)
    # Half of the time a bump must pass less than a quarter period, or it averages the effect away.
    fastest = 2 * np.pi / (float(np.percentile(travel[moving], 20)) * problem.bumps.width)
    sampled = np.interp(np.arange(len(recording)), problem.centre, regression.residual)
    weights = np.where(moving, sampled * factor, 0.0)
    return wave_numbers(recording["position"], weights, fastest, least)
