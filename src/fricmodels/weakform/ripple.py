"""Waves over position that are too fast for the rows: which wave number an effect has, and the rows that show it."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.drive import Drive
from fricmodels.term import Effect
from fricmodels.weakform.candidate import Candidate, NonlinearOptimum
from fricmodels.weakform.carriers import CarrierFunctions
from fricmodels.weakform.lines import Line, Whitened, averaged_from, fast_band, fast_lines
from fricmodels.weakform.optimise import coordinate_search, refine
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.steps import Steps
from fricmodels.weakform.test_functions import TestFunctions

_HARMONICS = 8
"""Greatest multiple of a wave number that is told."""
_WIDEST = 256
"""Most samples that a test function with a carrier spans."""


@dataclass(frozen=True)
class Waves:
    """The fast waves of a residual.

    Attributes:
        lines: the largest first.
        k: wave number of the largest, or half of it where there is a line, too: a wave with its second harmonic.
        resolution: π over the range of position; closer wave numbers are not told apart.
        independent: how many wave numbers were looked at.
        duration: time in which the drive passes a wave of the first line, half of the time [s].
    """

    lines: tuple[Line, ...]
    k: float
    resolution: float
    independent: float
    duration: float

    @property
    def carriers(self) -> tuple[float, ...]:
        """The wave number and its double, which belongs to every periodic effect."""
        return (self.k, 2.0 * self.k)


def fast_waves(
    problem: WeakFormProblem, parameters: Mapping[str, float], significance: float, least: float
) -> Waves | None:
    """Return the waves that are too fast for the rows; ``None`` where there are none.

    Args:
        problem: rows without carriers.
        parameters: of the fitted model.
        significance: corrected p-value below which a line is one.
        least: RMS torque below which a line is not looked for [N m or N].
    """
    band = fast_band(problem)
    if band is None:
        return None
    white = Whitened(Steps.of(problem, parameters))
    if not white.tells:
        return None
    # What is left of a wave that the model has is how well the samples show it, not another one.
    known = [k for effect in problem.drive.model.effects for k in wave_numbers(effect, parameters) if k < band[1]]
    white = white.with_residual(white.without(known))
    lines, white = fast_lines(white, band, significance, least)
    if not lines:
        return None
    resolution = np.pi / white.steps.span
    # A line at half the wave number need not stand out of all others: it is asked for by name, in what the lines leave.
    lines = tuple(sorted(lines, key=lambda line: line.torque, reverse=True))
    first = lines[0]
    half = next((line for line in lines if abs(line.k - 0.5 * first.k) < resolution), None)
    if half is None:
        asked = white.test(0.5 * first.k)
        if max(asked.p_value, white.rank(asked.k)) < significance and asked.torque >= least:
            half, lines = asked, (*lines, asked)
    passed = float(np.median(np.abs(white.steps.passed[white.steps.used])))
    return Waves(
        lines,
        first.k if half is None else 0.5 * first.k,
        resolution,
        (band[1] - band[0]) / resolution,
        2 * np.pi / (first.k * passed) * problem.recording.interval,
    )


def relations(waves: Waves) -> dict[float, str]:
    """Return in words what each further line is of those before it: a multiple of one, or the sum or difference of two.

    A wave number is known to a part of the resolution; agreement by chance is as rare as two lines that meet within it.
    """
    found: dict[float, str] = {}
    known = sorted({waves.k, *(line.k for line in waves.lines)})
    for k in known:
        others = [other for other in known if other < k and other not in found]
        multiples = [
            (m, one) for one in others for m in range(2, _HARMONICS + 1) if abs(k - m * one) < waves.resolution
        ]
        sums = [(one, two) for one, two in itertools.combinations(others, 2) if abs(one + two - k) < waves.resolution]
        if multiples:
            found[k] = f"{multiples[0][0]} × {multiples[0][1]:.4g}"
        elif sums:
            found[k] = f"{sums[0][0]:.4g} + {sums[0][1]:.4g}"
    return found


def carriers_alone(problem: WeakFormProblem, carriers: Sequence[float]) -> WeakFormProblem:
    """Return the same problem with nothing but rows that carry waves over position.

    The wider a test function, the less noise passes: it is widened while that costs less than half of the motion.
    """
    recording, own = problem.recording, problem.test_functions
    unclear, plain = ~own.covered(len(recording)), own
    while 2 * plain.width <= _WIDEST:
        wider = TestFunctions(recording, 2 * plain.width, unclear, least_moving=1.0, over_cells=own.over_cells)
        if wider.count * wider.hop < 0.5 * own.count * own.hop:
            break
        plain = wider
    test_functions = CarrierFunctions(plain, recording, carriers, alone=True)
    return replace(problem, test_functions=test_functions, carriers=tuple(carriers))


def of_waves(
    problem: WeakFormProblem, regression: Regression, effect: Effect, alone: Drive, waves: Waves
) -> NonlinearOptimum | None:
    """Return an effect with its wave number at that of a fast wave; ``None`` where it shows nothing there.

    Args:
        problem, regression: rows with carriers.
        effect: a candidate whose one nonlinear parameter is a wave number, or one in the angle itself, without any.
        alone: a drive with nothing but the effect.
        waves: what was found.
    """
    candidate = Candidate(problem, regression, effect, alone)
    if not candidate.nonlinear:
        found = candidate.found((), waves.independent) if abs(waves.k - 1.0) < waves.resolution else None
        return found if found is not None and np.any(found.kept) else None
    bounds = [(max(p.lower, waves.k - waves.resolution), waves.k + waves.resolution) for p in candidate.nonlinear]
    spacing = [-0.25 * waves.resolution]
    point = coordinate_search(candidate.explained, (waves.k,), bounds, spacing)
    point = refine(candidate.explained, point, bounds, spacing)
    found = candidate.found(point, waves.independent)
    return found if np.any(found.kept) else None


def carriers_of(
    problem: WeakFormProblem, start: Mapping[str, float], effects: Collection[str] | None = None
) -> tuple[float, ...]:
    """Return the wave numbers of a drive's effects over position that are too fast for the rows.

    Args:
        problem: rows without carriers.
        start: values of nonlinear parameters by key.
        effects: names of the effects that count; all if not given.
    """
    chosen = [e for e in problem.drive.model.effects if effects is None or e.name in effects]
    waves = [k for effect in chosen for k in wave_numbers(effect, start)]
    limit = averaged_from(problem) if waves else np.inf
    return tuple(k for k in waves if k > limit)


def wave_numbers(effect: Effect, values: Mapping[str, float]) -> tuple[float, ...]:
    """Return the wave numbers at which an effect has a torque over position: of one in the angle itself 1.

    Args:
        effect: a periodic one has its wave number, and twice that.
        values: of parameters by key; one that has none there has no wave number yet.
    """
    keys = [f"{effect.name}.{p.symbol}" for p in effect.parameters if p.periodic]
    known = [m * values[key] for key in keys if key in values for m in (1.0, 2.0)]
    return (1.0, *known) if effect.angular else tuple(known)
