r"""What the errors of an integrated position do to an estimate: its rows are evaluated with the position elsewhere.

The integral of a velocity wanders with its noise, more and more, and slowly: a torque over the position is then where
the model has another, and no residual of so few independent errors tells by how much the estimate is off. How large the
noise of the velocity is, is known. Each drawing of it, integrated, moves the rows by :math:`-\delta X\,\theta` and the
estimate with them, as the steps of a sensor do (:mod:`.staircase`).

Where a run begins is not known, so that its zero is anywhere: only by how much the position wanders about its mean is
an error. An offset of the velocity's sensor is in no noise, and is not reckoned with.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.integrated import from_zero
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.row_noise import velocity_noise_like
from fricmodels.weakform.staircase import errors_of_staircase

_DRAWS = 16


def scatter_of_position(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    """Return by how much what is left of the rows would differ, had the velocity other errors of the same kind.

    Args:
        problem: the rows.
        parameters: of the drive, by key, the inertia among them.

    Returns:
        Shape (draws, rows); no draws where a position was recorded, or nothing goes with it.
    """
    drive, derived = problem.drive, problem.recording.derived
    if "position" not in derived or "position" not in drive.model.needs or drive.model.states:
        return np.zeros((0, problem.rows))  # where it has a memory, what errors do through it is not reckoned with
    return problem.integrated(("integral of the velocity",), lambda: _scatter(problem, parameters))


def _scatter(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    drive, points, cell = problem.drive, problem.quadrature.recording, problem.quadrature.cell
    pairs = list(zip(drive.split(parameters)[1], drive.model.linear, strict=True))
    theta = np.array([value for value, linear in pairs if linear])
    nonlinear = [value for value, linear in pairs if not linear]

    def friction(recording: Recording) -> Array:
        design, offset = drive.regressors(recording, nonlinear)
        return np.asarray(problem.test_functions.torques(problem.quadrature, (theta @ design + offset)[None])[0])

    here, before = points["position"], friction(points)
    found = []
    for error in _errors_of_position(problem.recording):
        elsewhere = here + np.concatenate([error, error[cell], error[cell + 1]])
        found.append(before - friction(points.with_channels(position=elsewhere)))
    return np.array(found)


@once
def _errors_of_position(recording: Recording) -> Array:
    """Return errors that the integral of the velocity may have, of mean zero in each run, shape (draws, N)."""
    errors = errors_of_staircase(recording)
    if not len(errors):
        errors = np.array([velocity_noise_like(recording, np.random.default_rng(draw)) for draw in range(_DRAWS)])
    found = np.array([from_zero(recording, error) for error in errors])
    for number in recording.run_numbers:
        inside = recording.run == number
        found[:, inside] -= found[:, inside].mean(axis=1, keepdims=True)
    return found
