"""A candidate effect on the rows: what it explains wherever its nonlinear parameters are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.dimension import DIMENSIONLESS, DISPLACEMENT, FORCE, INERTIA
from fricmodels.drive import Drive
from fricmodels.parameter import Parameter
from fricmodels.term import Effect
from fricmodels.weakform.optimise import Point
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.ranges import scan_size, within_motion
from fricmodels.weakform.regression import Regression

_FARTHEST = 5.0
"""How far beyond the largest and the smallest that is tried first a parameter may go."""


@dataclass(frozen=True)
class NonlinearOptimum:
    """The best values found for an effect's nonlinear parameters.

    Attributes:
        nonlinear: their values, in order.
        columns: the effect's linear columns there that count, shape (q, rows).
        kept: which of the linear parameters these are; the others are zero.
        explained: sum of squares that they explain beyond the base model.
        trials: about how many independent values were tried; it multiplies the p-value.
        delay: the effect's delay [s], where one of its linear parameters is such; its column holds the whole shift.
        at_search_bound: whether an effect with memory explains most at the end of what this recording can tell.
    """

    nonlinear: Point
    columns: Array
    kept: Mask
    explained: float
    trials: float
    delay: float = 0.0
    at_search_bound: bool = False


@dataclass(frozen=True)
class Candidate:
    """An effect that may be missing.

    Attributes:
        problem, regression: the rows.
        effect: the effect.
        alone: a drive with nothing but it.
        delay: its delay [s], where one of its linear parameters is such.
    """

    problem: WeakFormProblem
    regression: Regression
    effect: Effect
    alone: Drive
    delay: float = 0.0

    @cached_property
    def linear(self) -> list[Parameter]:
        """The linear parameters."""
        return [p.declared for p in self.alone.model.linear_parameters]

    @cached_property
    def nonlinear(self) -> list[Parameter]:
        """The others, with the bounds that this recording sets."""
        return [within_recording(self.problem, p.declared) for p in self.alone.model.nonlinear_parameters]

    def columns(self, point: Point) -> Array:
        """Return the linear columns, shape (q, rows)."""
        return self.problem.columns(self.alone, point, self.delay)[0]

    def explained(self, point: Point) -> float:
        """Return the sum of squares that the columns explain beyond the base model, within bounds."""
        return self.regression.explained(self.columns(point), self._least, self._most(point))[0]

    def is_visible(self, point: Point) -> bool:
        """Whether anything is left of the columns beside the base model."""
        return bool(np.any(self.regression.visible(self.columns(point))))

    def found(self, point: Point, trials: float, *, at_search_bound: bool = False) -> NonlinearOptimum:
        """Return what is found at a point after so many trials."""
        columns = self.columns(point)
        explained, theta = self.regression.explained(columns, self._least, self._most(point))
        kept = theta != 0
        return NonlinearOptimum(point, columns[kept], kept, explained, trials, self.delay, at_search_bound)

    @cached_property
    def _least(self) -> Array:
        return np.array([lower_bound(self.problem, p) for p in self.linear])

    @cached_property
    def _declared(self) -> Array:
        return np.array([upper_bound(self.problem, p) for p in self.linear])

    @cached_property
    def _peak(self) -> float:
        return float(np.max(np.abs(self.problem.recording.velocity)))

    def _most(self, point: Point) -> Array:
        """Return the most of each linear parameter: a part of the drive has no more friction than all of it."""
        if type(self.effect).own_friction is Effect.own_friction:
            return self._declared
        given = {p.symbol: x for p, x in zip(self.nonlinear, point, strict=True)} | {p.symbol: 0.0 for p in self.linear}
        each = np.array([self.effect.own_friction(self._peak, given | {p.symbol: 1.0}) for p in self.linear])
        return np.asarray(np.minimum(self._declared, self.problem.friction_limits[1] / np.maximum(each, 1e-300)))


def lower_bound(problem: WeakFormProblem, parameter: Parameter) -> float:
    """Return the least that a linear coefficient may be: of what a drive may lack of its inertia, minus a share."""
    if not parameter.less_of_drive:
        return parameter.lower
    return -parameter.less_of_drive * (problem.drive.inertia or float("inf"))


def upper_bound(problem: WeakFormProblem, parameter: Parameter) -> float:
    """Return the most that a linear coefficient may be: of a share of the drive, all that this is known to have.

    Of friction that is all that the drive has. How the fit without the effect divides it between viscous and other
    parts is not known so well while the effect is missing; the fit with it holds the one to the other.
    """
    if not parameter.part_of_drive:
        return parameter.upper
    if parameter.dimension == INERTIA:
        return problem.drive.inertia or parameter.upper
    return problem.friction_limits[parameter.dimension == FORCE]


def within_recording(problem: WeakFormProblem, parameter: Parameter) -> Parameter:
    """Return a parameter with the bounds that a recording sets: sizes of which it can tell.

    None is much larger or smaller than what is tried first: a load whose friction stops it a million times sooner than
    the drive ever stops is another effect in disguise, and so is a stiction that rises between two samples. A length is
    no more than the travel, since a longer one was never crossed. See also :func:`~.ranges.within_motion`.
    """
    parameter = within_motion(problem.recording, parameter)
    dimension, scan = parameter.dimension, parameter.scan
    if dimension == DIMENSIONLESS or parameter.periodic or parameter.instant or parameter.place:
        return parameter
    size = scan_size(problem.recording, parameter)
    lower, upper = parameter.lower, parameter.upper
    if scan and min(scan) > 0:
        least = size * min(scan) / (1.0 if parameter.slow else _FARTHEST)
        lower, upper = max(lower, least), min(upper, size * _FARTHEST * max(scan))
    if dimension == DISPLACEMENT:
        upper = min(upper, size)
    if lower > upper:  # declared where the recording tells nothing
        return parameter
    return replace(parameter, initial=min(max(parameter.initial, lower), upper), lower=lower, upper=upper)
