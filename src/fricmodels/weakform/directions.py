"""The directions in which a model can move the rows by itself: what a candidate must add to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.weakform.problem import WeakFormProblem


def base_directions(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    """Return the directions in which the model under test can move by itself, shape (k, rows).

    Its linear columns, the tangents of its nonlinear parameters at their estimates, and its inertia if that is
    estimated.

    Args:
        problem: drive and rows.
        parameters: the model's estimated parameters by key.
    """
    drive = problem.drive
    pairs = list(zip(drive.model.parameters, drive.model.linear, strict=True))
    nonlinear = [parameters[p.key] for p, linear in pairs if not linear]
    theta = np.array([parameters[p.key] for p, linear in pairs if linear])
    columns, _ = problem.columns(drive, nonlinear)
    stacked = [columns]
    for i, value in enumerate(nonlinear):
        step = 1e-4 * abs(value) or 1e-6
        ends = []
        for moved in (value - step, value + step):
            design, offset = problem.columns(drive, [*nonlinear[:i], moved, *nonlinear[i + 1 :]])
            ends.append(theta @ design + offset)
        stacked.append(((ends[1] - ends[0]) / (2 * step))[None])
    if drive.inertia is None:
        stacked.append(problem.momentum[None])
    return np.vstack(stacked)
