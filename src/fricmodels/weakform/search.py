"""Finds the nonlinear parameters of a candidate effect: delays, widths, wave numbers, instants."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import DIMENSIONLESS, Motion
from fricmodels.drive import Drive
from fricmodels.parameter import Parameter
from fricmodels.signals.order_spectrum import WaveNumbers, wave_numbers
from fricmodels.term import Effect
from fricmodels.weakform.candidate import Candidate, NonlinearOptimum
from fricmodels.weakform.optimise import ROUNDS, Point, coordinate_search, halved, multistart_nelder_mead, refine
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.ranges import between_strokes, scan_size, scan_values
from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.shifted import FREE_SHIFT

_SHIFTS = (FREE_SHIFT, 1, 2, 3, 5, 8, 12, 18, 27, 40)
"""Delays that are tried first, in samples."""
_STARTS, _FEW = 4, 2
"""Where there is more than one nonlinear parameter there may be several summits: so many starts are tried. More than a
few are sought together; one of which a single value is tried first, as a shape, makes no further summit."""
_FIRST_ROUNDS = 3
"""Rounds of a coordinate search from every start; the best of them goes on."""
_HOPELESS, _NEAR = 0.05, 0.5
"""What explains less than this share of the residual, or of what another effect explains, is sought no further."""
_UNLIKELY = 0.25
"""Nor is what explains less than this share of that from its best start."""
_HARMONIC = 0.2
"""A wave of half the wave number must explain a fifth of all more; other waves make it explain a little more."""
_LOWER_WAVE = 0.5
"""What explains less than half as much after the first rounds will not explain nearly as much."""
_AT_END = 1e-3
"""Within a thousandth of a bound a parameter is at its end."""
_FINER, _AS_HIGH = 16, 0.75
"""Parts of the spacing of instants that are tried next to the best of them, and next to others that explain as much."""
_SIGNED = 0.2
"""Spacing of a parameter of either sign of which only one value is tried first."""


def search(
    problem: WeakFormProblem, regression: Regression, effect: Effect, alone: Drive, rival: float = 0.0
) -> NonlinearOptimum | None:
    """Return the best nonlinear parameters of an effect, or ``None`` where none makes it visible.

    Args:
        problem, regression: the rows.
        effect: the candidate.
        alone: a drive with nothing but the effect.
        rival: sum of squares that another effect explains. What does not come near it is sought no further.
    """
    if alone.model.delay:
        regression = regression.unshifted
    candidate = Candidate(problem, regression, effect, alone)
    if not candidate.nonlinear:
        if alone.model.delay:
            candidate = replace(candidate, delay=_delay(problem, regression, alone))
        found = candidate.found((), 2.0 * len(_SHIFTS) if candidate.delay else 1.0)
        return found if np.any(found.kept) or np.any(regression.visible(problem.columns(alone)[0])) else None
    points, spacing, trials, nonlinear = starting_points(problem, regression, alone, candidate.nonlinear)
    points = [point for point in points if _is_sought(problem, nonlinear, point)]
    if not points:
        return None
    value = cache(lambda point: candidate.explained(point) if _is_sought(problem, nonlinear, point) else 0.0)
    starts = sorted(points, key=value, reverse=True)
    if any(p.instant for p in nonlinear):
        high = [start for start in starts if value(start) >= _AS_HIGH * value(starts[0])]
        closer = _closer(high, nonlinear, spacing)
        starts = sorted(dict.fromkeys([*starts, *closer]), key=value, reverse=True)
    if value(starts[0]) <= 0:
        return candidate.found(starts[0], trials) if candidate.is_visible(starts[0]) else None
    worth = max(_HOPELESS * float(regression.residual @ regression.residual), _NEAR * rival)
    bounds = [(p.lower, p.upper) for p in nonlinear]
    together = sum(len(p.scan) > 1 for p in nonlinear) > _FEW
    best = _summit(value, starts, bounds, spacing, worth, together)
    if any(p.periodic for p in nonlinear):
        best = _fundamental(value, best, nonlinear, bounds, spacing)
    at_search_bound = bool(effect.states) and is_at_an_end(nonlinear, best, spacing)
    return candidate.found(best, trials, at_search_bound=at_search_bound)


def _summit(
    value: Callable[[Point], float],
    starts: Sequence[Point],
    bounds: Sequence[tuple[float, float]],
    spacing: Sequence[float],
    worth: float,
    together: bool = False,
) -> Point:
    """Return where most is explained; ``starts`` are the most hopeful first, ``worth`` is what it must come near."""
    if together:
        best = multistart_nelder_mead(value, starts, bounds, spacing, worth)
        if value(best) < worth:  # it was given up
            return best
    else:
        best = coordinate_search(value, starts[0], bounds, spacing, _FIRST_ROUNDS)
        more = starts[1:_STARTS] if len(bounds) > 1 and value(best) >= _UNLIKELY * worth else ()
        begun = (coordinate_search(value, start, bounds, spacing, _FIRST_ROUNDS) for start in more)
        best = max((best, *begun), key=value)
        if value(best) >= _UNLIKELY * worth:
            best = coordinate_search(value, best, bounds, halved(spacing, _FIRST_ROUNDS), ROUNDS - _FIRST_ROUNDS)
    return refine(value, best, bounds, spacing) if value(best) >= _UNLIKELY * worth else best


def _closer(points: Sequence[Point], nonlinear: Sequence[Parameter], spacing: Sequence[float]) -> Iterator[Point]:
    """Yield the points between each of some points and its neighbours that a parameter is an instant of.

    What is explained falls off within the strokes next to the true instant, and is the same all the time that a drive
    rests: a step uphill from afar sees neither, and the best of the first points may stand where the drive rests.
    """
    for i, (parameter, step) in enumerate(zip(nonlinear, spacing, strict=True)):
        if not parameter.instant:
            continue
        found: dict[tuple[Point, int, Point], Point] = {}
        for point in points:
            before, after = point[:i], point[i + 1 :]
            for part in range(-_FINER, _FINER + 1):
                instant = min(max(point[i] + part / _FINER * abs(step), parameter.lower), parameter.upper)
                found.setdefault((before, round(instant / abs(step) * _FINER), after), (*before, instant, *after))
        yield from found.values()


def _fundamental(
    value: Callable[[Point], float],
    found: Point,
    nonlinear: Sequence[Parameter],
    bounds: Sequence[tuple[float, float]],
    spacing: Sequence[float],
) -> Point:
    """Return the largest of k, 2k and k/2 that explains nearly as much as the best of them.

    An effect with a second harmonic explains a wave as that of half its wave number, too, with nothing in the first.
    """
    points = {found}
    for factor in (0.5, 2.0):
        moved = tuple(factor * x if p.periodic else x for p, x in zip(nonlinear, found, strict=True))
        if all(lower <= x <= upper for x, (lower, upper) in zip(moved, bounds, strict=True)):
            near = coordinate_search(value, moved, bounds, spacing, _FIRST_ROUNDS)
            if value(near) >= _LOWER_WAVE * value(found):
                near = coordinate_search(value, near, bounds, halved(spacing, _FIRST_ROUNDS), ROUNDS - _FIRST_ROUNDS)
            points.add(near)
    enough = (1 - _HARMONIC) * max(map(value, points))
    return max(point for point in points if value(point) >= enough)


def is_at_an_end(nonlinear: Sequence[Parameter], point: Point, spacing: Sequence[float]) -> bool:
    """Whether a parameter with a size went as far as this recording can tell, and makes a difference.

    Args:
        nonlinear: with the bounds of this recording.
        point: their values.
        spacing: as of :func:`starting_points`.
    """
    pairs = ((p, x) for p, x, step in zip(nonlinear, point, spacing, strict=True) if step != 1.0)
    return any(is_at_end(p, x) for p, x in pairs)


def is_at_end(parameter: Parameter, value: float) -> bool:
    """Whether a size, with the bounds of a recording, is as far as this can tell, where that is doubtful."""
    both: tuple[Literal["lower", "upper"], ...] = () if parameter.dimension == DIMENSIONLESS else ("lower", "upper")
    ends = both if parameter.doubtful_ends is None else parameter.doubtful_ends
    return any(math.isclose(value, getattr(parameter, end), rel_tol=_AT_END) for end in ends)


def _delay(problem: WeakFormProblem, regression: Regression, alone: Drive) -> float:
    """Return the delay [s] that, as a whole shift in time, explains most of the residual: the best of a few, refined.

    A shorter one than ``FREE_SHIFT`` is how recordings are made, see :mod:`.shifted`.
    """
    from scipy.optimize import minimize_scalar

    interval = problem.recording.interval

    def left(samples: float) -> float:
        delay = samples * interval
        columns, _ = problem.columns(alone, delay=delay)
        rest = regression.residual - delay * regression.project_out(columns)[0]
        return float(rest @ rest)

    side = min((1, -1), key=lambda side: min(left(side * samples) for samples in _SHIFTS))
    best = min(range(len(_SHIFTS)), key=lambda i: left(side * _SHIFTS[i]))
    ends = side * _SHIFTS[max(best - 1, 0)], side * _SHIFTS[min(best + 1, len(_SHIFTS) - 1)]
    refined = minimize_scalar(left, bounds=sorted(ends), method="bounded", options={"xatol": 0.01})
    return float(refined.x) * interval


def _is_sought(problem: WeakFormProblem, nonlinear: Sequence[Parameter], point: Point) -> bool:
    """Whether no parameter has a value at which the effect is another one."""
    if problem.drive.motion is not Motion.ROTARY:
        return True
    between = [(p.not_between, x) for p, x in zip(nonlinear, point, strict=True) if p.not_between]
    return not any(apart[0] < x < apart[1] for apart, x in between)


def starting_points(
    problem: WeakFormProblem, regression: Regression, alone: Drive, nonlinear: list[Parameter]
) -> tuple[list[Point], list[float], float, list[Parameter]]:
    """Return starting points, the spacing of each parameter (a ratio if positive, else a difference, as of
    :func:`fricmodels.weakform.optimise.multistart_nelder_mead`), and the trials.

    The parameters come back with the bounds that this recording sets: a period must be passed as a whole. There are no
    points where it could not tell an instant.
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
        if parameter.instant:
            first, last = between_strokes(problem.recording)
            first, last = max(parameter.lower, first), min(parameter.upper, last)
            if first > last:
                return [], [], 0.0, []
            parameter = replace(parameter, lower=first, upper=last, initial=min(max(parameter.initial, first), last))
        bounded.append(parameter)
        size = scan_size(problem.recording, parameter)
        tried = scan_values(problem.recording, parameter) or [parameter.initial]
        scan = list(dict.fromkeys(min(max(value, parameter.lower), parameter.upper) for value in tried))
        choices.append(scan)
        trials *= len(scan)
        known = tried if parameter.instant else scan  # a bound may have moved the first instant next to the second
        if parameter.lower < 0 or parameter.instant or parameter.place or scan[0] <= 0:
            spacing.append(-(known[1] - known[0]) if len(known) > 1 else -_SIGNED * size)
        else:
            spacing.append(scan[1] / scan[0] if len(scan) > 1 else 2.0)
    for i in _idle(problem, alone, choices):
        trials /= len(choices[i])
        choices[i], spacing[i] = choices[i][:1], 1.0
    return [tuple(point) for point in itertools.product(*choices)], spacing, trials, bounded


def _idle(problem: WeakFormProblem, alone: Drive, choices: list[list[float]]) -> list[int]:
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


def in_gap(instant: float, time: Array, resolution: float) -> float:
    """Return the middle of the gap, longer than the resolution, that an instant lies in or next to; else the instant.

    Nothing was recorded within a gap, or what was is kept back, so that nothing tells where in it something happened.
    """
    before = np.flatnonzero(np.diff(time) > resolution)
    near = before[(time[before] - resolution < instant) & (instant < time[before + 1] + resolution)]
    return float(0.5 * (time[near[0]] + time[near[0] + 1])) if len(near) else instant


def _wave_numbers(problem: WeakFormProblem, regression: Regression, alone: Drive, least: float) -> WaveNumbers:
    """Return the wave numbers at which the residual is most periodic in position.

    The residual is multiplied by what the effect's torque is in proportion to: its column at wave number 0.
    """
    design, _ = problem.evaluate(alone, [0.0] * sum(not flag for flag in alone.model.linear))
    return periods(problem, regression, design[0, : len(problem.recording)], least)


def periods(problem: WeakFormProblem, regression: Regression, factor: Array, least: float) -> WaveNumbers:
    """Return the wave numbers at which the residual times ``factor``, shape (N,), is most periodic in position.

    A wave that is faster than the rows show well has skirts in what they show, and these fit worse than the wave. So an
    octave more is looked at, as long as something is higher there, and samples pass less than half a wave.
    """
    recording, fastest = problem.recording, fastest_in_rows(problem)
    if fastest is None:
        return WaveNumbers((), 1.0, 1.0)
    moving = ~problem.resting & (problem.smooth != 0)
    sampled = np.interp(np.arange(len(recording)), problem.centre, regression.residual)
    weights = np.where(moving, sampled * factor, 0.0)
    found = wave_numbers(recording["position"], weights, fastest, least)
    end = 0.5 * problem.test_functions.width * fastest
    while fastest < end:
        slower, fastest = fastest, min(2.0 * fastest, end)
        faster = wave_numbers(recording["position"], weights, fastest, max(slower, least))
        if faster.height <= found.height:
            break
        found = found.and_faster(faster)
    return found


def fastest_in_rows(problem: WeakFormProblem) -> float | None:
    """Return the greatest wave number that the rows show; ``None`` where nothing moves.

    A fifth of the time a test function must pass less than a whole wave, or it averages the effect away, and what is
    left fits any other as well. Faster ones are found in the samples, see :mod:`.lines`.
    """
    travel = np.abs(problem.smooth) * problem.recording.interval * relative_intervals(problem.recording)
    moving = ~problem.resting & (travel > 0)
    if not np.any(moving):
        return None
    return float(2 * np.pi / (float(np.percentile(travel[moving], 20)) * problem.test_functions.width))
