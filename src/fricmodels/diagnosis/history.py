"""What happened since the drive last turned or started, for channel predictors of effects with memory."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmodels.arrays import Array, Mask
from fricmodels.signals import smoothed_velocity
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.unclear import CERTAIN


@dataclass(frozen=True)
class MotionHistory:
    """Time and distance since the last reversal and the last start, at each sample of the quadrature.

    Attributes:
        side: direction of the motion, ±1; where it is uncertain, that in which the drive last certainly moved.
        turned: time since it last changed [s]; travelled: distance since then [rad or m].
        started: time since the drive last began to move, in either direction [s]; moved: distance since then.
        dwell: how long it had rested before that [s].
    """

    side: Array
    turned: Array
    travelled: Array
    started: Array
    moved: Array
    dwell: Array

    @classmethod
    def of(cls, problem: WeakFormProblem) -> MotionHistory:
        """Follow a recording through its reversals and rests; noise about zero speed is neither."""
        recording, cell, rest = problem.recording, problem.quadrature.cell, _at_rest(problem)
        _, error = smoothed_velocity(recording)
        sure = ~rest & (np.abs(problem.smooth) > CERTAIN * error)
        fresh = np.concatenate([[True], np.diff(recording.run) != 0])
        sign = np.sign(problem.smooth)
        turned, side = _turns(sign, sure, fresh)
        started = turned | np.concatenate([[False], rest[:-1] & ~rest[1:]])
        time, distance = recording.time, _path(problem)
        followed = (
            side,
            time - _latest(time, turned),
            distance - _latest(distance, turned),
            time - _latest(time, started),
            distance - _latest(distance, started),
            _latest(_rested(problem, rest, fresh), started),
        )
        after = np.minimum(cell + 1, len(time) - 1)
        return cls(*(np.concatenate([values, values[cell], values[after]]) for values in followed))


def _at_rest(problem: WeakFormProblem) -> Mask:
    """Return where the drive rests; a motion shorter than half a test function within a rest is one of its noise."""
    rest = problem.resting.copy()
    edges = np.flatnonzero(np.diff(rest.astype(np.int8))) + 1
    for start, stop in itertools.pairwise(edges):
        if not rest[start] and stop - start < problem.test_functions.width // 2:
            rest[start:stop] = True
    return rest


def _rested(problem: WeakFormProblem, rest: Mask, fresh: Mask) -> Array:
    """Return how long the last rest was, up to a smoothing window after its end; later 0 [s]."""
    time = problem.recording.time
    index = np.arange(len(time))
    before = np.concatenate([[False], rest[:-1]]) & ~fresh
    begins, ends = rest & ~before, before & ~rest
    length = np.where(ends, time - _latest(time, begins), 0.0)
    return np.where(index - _latest(index, ends | fresh) <= problem.half_width + 1, _latest(length, ends | fresh), 0.0)


def _turns(sign: Array, sure: Mask, fresh: Mask) -> tuple[Mask, Array]:
    """Return where the direction changes, at the zero before it is certain, and the direction from there on."""
    held = _latest(np.where(sure, sign, 0.0), sure | fresh)
    certain = np.flatnonzero(np.concatenate([[False], held[1:] != held[:-1]]) | fresh)
    index = np.arange(len(sign))
    other = np.maximum.accumulate(np.where(sign[None] != np.array([[1.0], [-1.0]]), index, -1), axis=1)
    before = np.where(held[certain] > 0, other[0, certain], other[1, certain])
    since = _latest(index, fresh)[certain]
    at = np.where(fresh[certain], certain, np.maximum(before + 1, since))
    turned = np.zeros(len(sign), dtype=bool)
    turned[at] = True
    side = np.zeros(len(sign))
    side[at] = held[certain]
    return turned, _latest(side, turned)


def _path(problem: WeakFormProblem) -> Array:
    """Return the distance travelled since the beginning, shape (N,)."""
    recording = problem.recording
    if recording.measures("position"):  # noise of a velocity would add up in its size
        step = np.abs(np.diff(recording["position"], prepend=recording["position"][0]))
    else:
        step = np.abs(problem.smooth) * recording.interval * relative_intervals(recording)
    return np.asarray(np.cumsum(np.where(problem.resting, 0.0, step)))


def _latest(values: NDArray[Any], where: Mask) -> NDArray[Any]:
    """Return the value at the latest sample that is marked, shape (N,)."""
    index = np.maximum.accumulate(np.where(where, np.arange(len(values)), 0))
    return np.asarray(values[index])
