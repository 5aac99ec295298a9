r"""Rows of runs whose noise is unlike: what a fit leaves of them says how much no model explains.

What looks like noise of a run may be its torque: that of a stiff controller, or of a fast motion. And what a model does
not explain is in all runs alike. The more that is, the more alike rows count.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.row_noise import alike_samples, row_counts, row_sizes

if TYPE_CHECKING:
    from fricmodels.weakform.problem import WeakFormProblem


def weighed(problem: WeakFormProblem, parameters: Mapping[str, float], inertia: float) -> WeakFormProblem:
    r"""Return a problem whose rows count by their noise and by what least squares leave of them beside it.

    Of the run of which they leave least: :math:`u^2 = s^2 / r^2 - v^2 / r^2 - t^2`, with s the RMS of what is left and
    r, v and t as in :func:`fricmodels.weakform.rates.weights_of_rows`.

    Args:
        problem: with rows that count by the noise of their runs.
        parameters: an estimate, by key, of which those count that are not linear.
        inertia: of the drive.
    """
    recording, counts, width = problem.recording, problem.bumps.counts, problem.bumps.width
    of = alike_samples(recording)
    if counts is None or of is None or not problem.rows:
        return problem
    drive, at, relative = problem.drive, problem.bumps.begins, relative_intervals(recording)
    every = zip(drive.model.parameters, drive.model.linear, strict=True)
    own = [] if drive.inertia is not None else [problem.momentum]
    columns = problem.columns(drive, [parameters[p.key] for p, linear in every if not linear])[0]
    design = np.vstack([columns, problem.sign_change, problem.torque_rate, *own])
    design /= np.maximum(np.linalg.norm(design, axis=1, keepdims=True), 1e-300)
    left = problem.target - np.linalg.lstsq(design.T, problem.target, rcond=None)[0] @ design
    sizes = row_sizes(recording, inertia, width)
    assert sizes is not None
    squares = (left / counts[at] / relative[at]) ** 2 - (sizes[0] / relative)[at] ** 2 - sizes[1][at] ** 2
    number = np.bincount(of[at], minlength=of.max() + 1)
    known = number > len(design)
    if not known.any():
        return problem
    unexplained = np.min(np.maximum(np.bincount(of[at], squares, len(number))[known] / number[known], 0.0))
    bumps = copy(problem.bumps)
    bumps.counts = row_counts(recording, inertia, width, float(np.sqrt(unexplained)))
    return replace(problem, bumps=bumps)
