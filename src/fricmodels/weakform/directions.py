"""The directions in which a model can move the rows by itself: what a candidate must add to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.weakform.problem import WeakFormProblem

_NOTHING = 1e-9
"""Share of the friction below which what a parameter changes is rounding, as where its amplitude is at a bound. Scaled
to length one it would be a direction of noise, another one with every last digit."""
_STEP = 1e-4
"""Share of a nonlinear parameter over which its tangent is taken, to either side."""


def base_directions(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    """Return the directions in which the model under test can move by itself, shape (k, rows).

    Its linear columns but those of parameters that are kept at their bound, the tangents of its nonlinear parameters at
    their estimates, and its inertia if that is estimated.

    Args:
        problem: drive and rows.
        parameters: the model's estimated parameters by key.
    """
    drive = problem.drive
    chosen, nonlinear = drive.model.nonlinear_parameters, drive.model.nonlinear_of(parameters)
    theta = np.array(drive.model.linear_of(parameters))
    columns, offset = problem.columns(drive, nonlinear)
    whole = float(np.abs(theta) @ np.linalg.norm(columns, axis=1) + np.linalg.norm(offset))
    free = [p.key not in problem.kept for p in drive.model.linear_parameters]
    stacked = [columns[free]]
    for i, value in enumerate(nonlinear):
        # An instant is a stair with a step at each sample, and what the clock says no size.
        step = problem.recording.interval if chosen[i].declared.instant else _STEP * abs(value) or 1e-6
        ends = []
        for moved in (value - step, value + step):
            design, offset = problem.columns(drive, [*nonlinear[:i], moved, *nonlinear[i + 1 :]])
            ends.append(theta @ design + offset)
        change = (ends[1] - ends[0]) / (2 * step)
        if np.linalg.norm(change) * step > _NOTHING * _STEP * whole:
            stacked.append(change[None])
    if drive.inertia is None:
        stacked.append(problem.momentum[None])
    return np.vstack(stacked)
