"""Where a drive is, and how fast, at a sample: what a simulation of its motion starts from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording

SAMPLES = 20
"""Samples that tell the first state, as the EMPS benchmark has it."""
_DEGREE = 2


@dataclass(frozen=True)
class State:
    """Where a drive is and how fast, and how sure that is.

    Attributes:
        position, velocity: at the sample. covariance: of these two, shape (2, 2), from what the parabola left.
    """

    position: float
    velocity: float
    covariance: Array


def state_at(run: Recording, index: int, count: int = SAMPLES) -> State:
    r"""Return position and velocity at a sample, from the samples about it.

    The position is a parabola through ``count`` samples, at the beginning of a run through the first ones, and the
    velocity its slope. A velocity that was measured is taken from a parabola through itself.

    Args:
        run: one run, with a velocity, measured or derived; its position is 0 at the start where none was measured.
        index: of the sample in the run.
        count: samples; fewer where the run is shorter.
    """
    count = min(count, len(run))
    first = min(max(index - count // 2, 0), len(run) - count)
    part = slice(first, first + count)
    time = run.time[part] - run.time[index]
    nowhere = (0.0, 0.0, np.zeros((2, 2)))
    position, slope, spread = _parabola(time, run["position"][part]) if "position" in run else nowhere
    if "velocity" in run.derived and "position" in run:
        return State(position, slope, spread)
    velocity, _, own = _parabola(time, run.velocity[part])
    return State(position, velocity, np.diag([spread[0, 0], own[0, 0]]))


def _parabola(time: Array, values: Array) -> tuple[float, float, Array]:
    """Return value and slope at time 0 of the least-squares parabola, and their covariance."""
    degree = min(_DEGREE, len(values) - 1)
    if degree < 1:
        return float(values[0]), 0.0, np.zeros((2, 2))
    scale = float(np.max(np.abs(time))) or 1.0
    basis = np.vander(time / scale, degree + 1, increasing=True)
    found = np.linalg.lstsq(basis, values, rcond=None)[0]
    left = values - basis @ found
    variance = float(left @ left) / max(len(values) - degree - 1, 1)
    spread = variance * np.linalg.inv(basis.T @ basis)[:2, :2] / np.outer([1.0, scale], [1.0, scale])
    return float(found[0]), float(found[1]) / scale, spread
