"""What a model leaves over all motion, the stretches included that the rows leave out.

Around standstill it is not known for certain how a drive moved, so the rows have no part in it. An effect that is
fitted to the rows alone may say anything there. What it says is judged roughly, by its size: by means over the two
cells about each sample, while the drive moves. A single sample beside a reversal may lie on either side of a jump.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmodels.arrays import Mask
from fricmodels.drive import Drive
from fricmodels.weakform.problem import WeakFormProblem


def residual_rms(
    problem: WeakFormProblem,
    effect: Drive | None = None,
    nonlinear: Sequence[float] = (),
    kept: Mask | None = None,
) -> float:
    """Return the RMS torque [N m or N] that a model leaves over all motion, with an effect or without.

    Args:
        problem: the fitted model and its rows.
        effect: a drive with nothing but the effect; without it, the model alone.
        nonlinear: the effect's nonlinear parameters.
        kept: which of its linear ones are free; all by default.
    """
    design, offset = problem.evaluate(problem.drive, problem.drive.model.nonlinear_of(problem.estimated or {}))
    acceleration = problem.quadrature.recording["acceleration"]
    if effect is not None:
        more, _ = problem.evaluate(effect, nonlinear)
        design = np.vstack([design, more if kept is None else more[kept]])
    integrated = problem.integrals(np.vstack([design, offset[None]]))
    columns, nuisances = integrated[:-1], np.vstack([problem.sign_change, problem.torque_rate])
    given = problem.drive.inertia
    if given is None:
        design, columns = np.vstack([design, acceleration]), np.vstack([columns, problem.momentum])
    stacked = np.vstack([columns, nuisances])
    size = np.linalg.norm(stacked, axis=1)
    size = np.where(size > 0, size, 1.0)
    solved = np.linalg.lstsq((stacked / size[:, None]).T, problem.target - integrated[-1], rcond=1e-10)[0] / size
    points = problem.quadrature.recording
    left = points.driving_torque - (given or 0.0) * acceleration - offset - solved[: len(design)] @ design
    impulse, time = problem.quadrature.under_hats(np.vstack([left, np.ones_like(left)]))
    moving = ~problem.resting & (time > 0.0)
    return float(np.sqrt(np.sum(impulse[moving] ** 2 / time[moving]) / np.sum(time[moving])))
