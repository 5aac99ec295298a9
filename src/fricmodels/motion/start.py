"""Where a drive is, and how fast, at a sample: what a simulation of its motion starts from."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording

SAMPLES = 20
"""Samples that tell the first state, as the EMPS benchmark has it."""
_DEGREE = 2


def state_at(run: Recording, index: int, count: int = SAMPLES) -> tuple[float, float]:
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
    position, slope = 0.0, 0.0
    if "position" in run:
        position, slope = _parabola(run.time[part] - run.time[index], run["position"][part])
    if "velocity" in run.derived and "position" in run:
        return position, slope
    return position, _parabola(run.time[part] - run.time[index], run.velocity[part])[0]


def _parabola(time: Array, values: Array) -> tuple[float, float]:
    """Return value and slope at time 0 of the least-squares parabola."""
    degree = min(_DEGREE, len(values) - 1)
    if degree < 1:
        return float(values[0]), 0.0
    scale = float(np.max(np.abs(time))) or 1.0
    basis = np.vander(time / scale, degree + 1, increasing=True)
    found = np.linalg.lstsq(basis, values, rcond=None)[0]
    return float(found[0]), float(found[1]) / scale
