"""Fits the torque equation at samples of filtered signals and their derivatives, as is usual in robotics (IDIM-LS)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals import Preparation
from fricmodels.signals.segments import stretches
from fricmodels.weakform.inference import covariance
from fricmodels.weakform.nonlinear import Outcome, Plan, linear_constraints, nonlinear_search
from fricmodels.weakform.separable import SeparableTerm, separable
from fricmodels.weakform.variable_projection import Equations, Projection


def derivative_equations(drive: Drive, recording: Recording, preparation: Preparation) -> tuple[Equations, Recording]:
    """Return the equation of motion at samples of filtered signals and their derivatives, and the filtered recording.

    Both sides are evaluated at every filtered sample and then low-pass filtered and decimated alike ("parallel
    filtering"). Source: M. Gautier, "Dynamic identification of robots with power model", 1997; A. Janot, M. Gautier,
    M. Brunot, "Data set and reference models of EMPS", 2019.
    """
    from scipy.signal import decimate

    from fricmodels.signals import prepare, resting

    marked = recording.with_channels(at_rest=resting(recording).astype(float))
    filtered = prepare(marked, preparation.model_copy(update={"decimate": 1, "smooth_velocity": True}))
    in_motion = 1.0 - filtered["at_rest"]
    factor = preparation.decimate
    parts = [part for part in stretches(filtered.time, filtered.run) if part.stop - part.start > 30 * factor]
    if not parts:
        raise EstimationError(f"recording '{recording.name}' is too short to keep every {factor}th sample only")

    def seen(rows: Array) -> Array:
        kept = [rows[:, part] * in_motion[part] for part in parts]
        return np.concatenate(kept if factor == 1 else [decimate(each, factor, axis=1) for each in kept], axis=1)

    split = separable(drive.model)

    def moving(alpha: Array, slopes: bool) -> list[Array]:
        def rows(term: SeparableTerm, own: tuple[float, ...]) -> Array:
            return seen(term.moving_rows(filtered, np.array(own), states, slopes=slopes))

        return split.moving_blocks(alpha, rows)

    def states(model: Model, parameters: Array) -> Sequence[Array]:
        return Drive(model, None, drive.motion).states(filtered, parameters)

    driving = seen(filtered.driving_torque[None])[0]
    acceleration = seen(filtered["acceleration"][None])[0]
    target = driving if drive.inertia is None else driving - drive.inertia * acceleration
    fixed = seen(split.fixed_rows(filtered))
    given = acceleration if drive.inertia is None else None
    return Equations(split, driving, target, given, fixed, moving), filtered


def derivative_fit(drive: Drive, recording: Recording, preparation: Preparation, plan: Plan) -> tuple[Outcome, float]:
    """Fit :func:`derivative_equations`; return the outcome, and ‖error‖/‖torque‖ over the equations.

    Args:
        drive: model, and inertia or ``None``.
        recording: as measured.
        preparation: filters.
        plan: where the nonlinear parameters start.
    """
    equations, filtered = derivative_equations(drive, recording, preparation)
    linear = [p for p in drive.parameters if p.linear]
    if len(equations.target) <= len(drive.parameters):
        raise EstimationError(
            f"recording '{recording.name}' gives {len(equations.target)} equations for {len(drive.parameters)} "
            "parameters of the drive; it moves too little or is too short"
        )
    constraints, limits = linear_constraints(linear)
    solution = Projection(equations, constraints, limits).solve(nonlinear_search(drive, filtered, plan))
    first, last = iter(range(len(linear))), iter(range(len(linear), len(drive.parameters)))
    order = np.array([next(first if p.linear else last) for p in drive.parameters])
    spread = covariance(solution.jacobian.T, solution.residual, solution.normal.inverse, float(len(equations.target)))
    message = "" if solution.converged else f"no minimum after {solution.iterations} iterations"
    values = np.concatenate([solution.theta, solution.alpha])[order]
    outcome = Outcome(values, spread[np.ix_(order, order)], solution.normal.null[order], solution.converged, message)
    return outcome, float(np.linalg.norm(solution.residual) / np.linalg.norm(equations.driving))
