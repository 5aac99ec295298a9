"""The directions in which a model can move the rows by itself: what a candidate must add to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
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
        step = problem.recording.interval if chosen[i].declared.instant else usual_step(value)
        change = tangent(problem, drive, nonlinear, i, step, lambda design, offset: theta @ design + offset)
        if np.linalg.norm(change) * step > _NOTHING * _STEP * whole:
            stacked.append(change[None])
    if drive.inertia is None:
        stacked.append(problem.momentum[None])
    return np.vstack(stacked)


def usual_step(value: float) -> float:
    """Return how far a nonlinear parameter is moved for its tangent, to either side."""
    return _STEP * abs(value) or 1e-6


def tangent(
    problem: WeakFormProblem,
    drive: Drive,
    nonlinear: Sequence[float],
    i: int,
    step: float,
    torque: Callable[[Array, Array], Array],
) -> Array:
    """Return how a torque in the rows changes with a nonlinear parameter, by its central difference, shape (rows,).

    Args:
        problem, drive: whose rows they are, and of which terms.
        nonlinear: their nonlinear parameters.
        i: which of them.
        step: to either side.
        torque: of the columns and of what is left without them.
    """
    moved = ([*nonlinear[:i], nonlinear[i] + side * step, *nonlinear[i + 1 :]] for side in (-1, 1))
    before, after = (torque(*problem.columns(drive, values)) for values in moved)
    return (after - before) / (2 * step)
