"""Finds the parameters with which the simulated motion comes nearest to the measured one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from fricmodels.arrays import Array, deviations
from fricmodels.dimension import Dimension
from fricmodels.errors import EstimationError
from fricmodels.motion.errors import MotionErrors, motion_errors
from fricmodels.motion.least_squares import STEP, jacobian
from fricmodels.motion.search import Found, Loss, absolute, searched
from fricmodels.motion.simulator import Simulator
from fricmodels.score.criteria import information_criteria
from fricmodels.weakform.inference import covariance
from fricmodels.weakform.least_squares import NormalEquations
from fricmodels.weakform.ranges import natural_size

Objective: TypeAlias = Literal["position", "velocity"]

_SMALL = 1e-2
"""Share of a parameter's natural size below which it is not counted in its own value."""


@dataclass(frozen=True)
class MotionFit:
    """Parameters found from simulated motion, in SI units.

    Attributes:
        parameters: values by key: the model's, the inertia where it was estimated, the loop's.
        estimated: keys of those that were found, in the order of :attr:`covariance`.
        covariance: holds for autocorrelated residuals; see :func:`fricmodels.weakform.inference.covariance`.
        undetermined: directions, in columns of unit length, that change nothing; shape (n, any number).
        errors: of the motion on what was fitted.
        converged: whether the search ended by itself.
        evaluations: simulations of the recording.
    """

    parameters: Mapping[str, float]
    estimated: tuple[str, ...]
    covariance: Array
    undetermined: Array
    errors: MotionErrors
    converged: bool
    evaluations: int

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each parameter."""
        spread = deviations(self.covariance)
        return dict(zip(self.estimated, spread.tolist(), strict=True))


@dataclass(frozen=True)
class Problem:
    """Parameters in order, and the residual that is made small.

    Attributes:
        simulator: of what is fitted. objective: the channel whose error is made small.
        keys: of the parameters. bounds: least and greatest value of each. size: of each, for differences.
        pairs: places of parameters of which the first must not be below the second.
    """

    simulator: Simulator
    objective: Objective
    keys: tuple[str, ...]
    bounds: tuple[Array, Array]
    size: Array
    pairs: tuple[tuple[int, int], ...]

    @classmethod
    def of(cls, simulator: Simulator, objective: Objective = "position") -> Problem:
        """Return the problem of a simulator; the velocity is fitted where no position was measured."""
        drive, loop, recording = simulator.drive, simulator.loop, simulator.recording
        listed = [(p.key, p.declared, p.dimension, p.at_least) for p in drive.parameters]
        if loop is not None:
            own = dict(zip(loop.parameters, loop.keys, strict=True))
            listed += [(own[p], p, p.dimension, None) for p in loop.free]
        keys = tuple(key for key, *_ in listed)
        low = np.array([p.lower for _, p, *_ in listed])
        high = np.array([p.upper for _, p, *_ in listed])
        size = np.array([_size(simulator, dimension) for *_, dimension, _ in listed])
        if drive.inertia is None:
            low[0] = max(low[0], 1e-9 * size[0])
        pairs = tuple((i, keys.index(other)) for i, (*_, other) in enumerate(listed) if other in keys)
        return cls(
            simulator,
            objective if recording.measures("position") else "velocity",
            keys,
            (low, high),
            _SMALL * size,
            pairs,
        )

    def values(self, at: Array) -> dict[str, float]:
        """Return parameters by key, and in the order that their declarations ask for."""
        ordered = at.copy()
        for i, other in self.pairs:
            ordered[i] = max(ordered[i], ordered[other])
        return dict(zip(self.keys, ordered.tolist(), strict=True))

    def residual(self, at: Array, moved_position: float = 0.0, moved_velocity: float = 0.0) -> Array:
        """Return simulated less measured, at every sample that is scored; see :class:`.Simulator` for what is moved."""
        position, velocity = self.simulator(self.values(at), moved_position, moved_velocity)
        measured = self.simulator.recording
        error = position - measured["position"] if self.objective == "position" else velocity - measured.velocity
        return error[self.simulator.scored]

    def at(self, values: Mapping[str, float]) -> Array:
        """Return values in order, those that are not given as declared."""
        drive, loop = self.simulator.drive, self.simulator.loop
        declared = {p.key: p.declared.initial for p in drive.parameters}
        if loop is not None:
            declared |= {key: p.initial for key, p in zip(loop.keys, loop.parameters, strict=True)}
        return np.array([values.get(key, declared[key]) for key in self.keys], dtype=float)


def _size(simulator: Simulator, dimension: Dimension) -> float:
    if not np.any(simulator.recording.torque):
        return 1.0  # in a closed loop the torque may not be known
    size = natural_size(simulator.recording, dimension)
    return size if np.isfinite(size) and size > 0 else 1.0


def fit_motion(
    simulator: Simulator,
    starts: Sequence[Mapping[str, float]],
    *,
    objective: Objective = "position",
    loss: Loss = "squares",
    most: int = 60,
    kinks: bool = True,
) -> MotionFit:
    r"""Return the parameters with the least squared (or absolute) error of the simulated motion.

    .. math:: \min_\theta \sum_k \big(q_k(\theta) - q_k\big)^2

    by :func:`fricmodels.motion.search.searched`: Levenberg–Marquardt from each start, and CMA-ES about the best end
    where the error has kinks. A start that is the optimum of a model which this one contains makes sure that the larger
    model is never worse on what is fitted.

    Args:
        simulator: of what is fitted: in one piece, where an error of force adds up, or in windows, which forget it.
        starts: parameters by key to begin from; those that are missing begin as declared.
        objective: ``position``, or ``velocity``.
        loss: ``squares``, or ``absolute`` (iteratively reweighted).
        most: Jacobians, for each start. kinks: whether to go on without derivatives where the error has kinks.

    Raises:
        EstimationError: where no start can be simulated to the end.
    """
    problem = Problem.of(simulator, objective)
    begun = [problem.at(start) for start in starts]
    best = searched(problem.residual, begun, problem.size, problem.bounds, loss=loss, most=most, kinks=kinks)
    if not np.isfinite(best.cost):
        raise EstimationError(
            f"the simulation of '{simulator.drive.model.name}' does not reach the end of "
            f"'{simulator.recording.name}' from any start; give a shorter horizon"
        )
    return _inferred(problem, best, loss)


def _inferred(problem: Problem, best: Found, loss: Loss) -> MotionFit:
    """Return the fit with its covariance; a parameter at its bound, or without effect, has none."""
    here = problem.residual(best.at)
    step = STEP * np.maximum(np.abs(best.at), problem.size)
    slope = np.nan_to_num(jacobian(problem.residual, best.at, here, step, problem.bounds))
    root = np.sqrt(absolute(here)) if loss == "absolute" else np.ones(len(here))
    slope, residual = slope * root[:, None], -here * root
    normal = NormalEquations.of(slope.T @ slope, slope.T @ residual)
    run = problem.simulator.recording.run[problem.simulator.scored]
    independent = information_criteria(residual, run, len(problem.keys))[2]
    spread = covariance(slope, residual, normal.inverse, independent)
    spread += _of_first_states(problem, best.at, here, slope * root[:, None], normal.inverse)
    return MotionFit(
        {**problem.simulator.drive_given, **problem.values(best.at)},
        problem.keys,
        spread,
        normal.null,
        motion_errors(problem.simulator, problem.values(best.at)),
        best.converged,
        best.evaluations + len(problem.keys) + 2,
    )


def _of_first_states(problem: Problem, at: Array, here: Array, slope: Array, inverse: Array) -> Array:
    r"""Return what errors of the states that windows start from add to the covariance.

    .. math:: \sum_w A_w \Sigma_w A_w^T, \qquad A_w = (J^TWJ)^{-1} J^TW\,\frac{\partial e}{\partial x_w}

    An error of a first state moves the whole window; what is left of the fit does not show it.
    """
    simulator = problem.simulator
    recording, scored = simulator.recording, simulator.scored
    moved = STEP * float(np.std(recording["position"])) if "position" in recording else 0.0
    lengths = (moved or STEP, STEP * float(np.max(np.abs(recording.velocity))) or STEP)
    by_position = (problem.residual(at, moved_position=lengths[0]) - here) / lengths[0]
    by_velocity = (problem.residual(at, moved_velocity=lengths[1]) - here) / lengths[1]
    place = np.cumsum(scored) - 1
    added = np.zeros((slope.shape[1], slope.shape[1]))
    for predicted, start in simulator.starts:
        rows = place[predicted]
        change = np.nan_to_num(np.column_stack([by_position[rows], by_velocity[rows]]))
        moves = inverse @ (slope[rows].T @ change)
        added += moves @ start.covariance @ moves.T
    return added
