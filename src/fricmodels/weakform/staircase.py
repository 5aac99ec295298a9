r"""What the steps of a sensor do to an estimate: its rows are evaluated anew with the steps elsewhere.

The error of a staircase goes with the motion. Under a motion that repeats itself it is the same in every cycle: least
squares takes it up, the residual does not show it, and no long-run variance does. But how large it is, is known: the
same staircase, moved by a part of its step, makes another error of the same kind. To first order each one moves the
estimate by

.. math:: \delta\theta = (X^T X)^{-1} X^T \left(-J\,\delta\!\int\!\varphi\,d\omega - \delta X\,\theta\right)

and the mean of :math:`\delta\theta\,\delta\theta^T` over evenly spaced places of the staircase is their covariance.

A staircase of the velocity has an offset besides, which no sample shows: values are rounded up, down or to the nearest
step, of a scale whose zero may lie anywhere within a step. It is taken to lie anywhere within a step either way.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative, motion_noise, quantum
from fricmodels.signals.rest import once
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.test_functions import mean_velocity

PLACES = 8
"""Places of the staircase, evenly spaced within a step."""
_ON_EDGE = 1e-9
"""Share of a step: what lies so near below an edge lies on it but for rounding, as means of few rounded values do."""
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Multiples of it, less whole numbers, are spread evenly: offsets that do not go with the places."""


@once
def errors_of_steps(recording: Recording) -> tuple[Array, Array]:
    """Return errors that the steps of the sensor of the motion may have made, shape (places, N); none without steps.

    Of the velocity whose changes are the momentum, and of the velocity that is smoothed for the friction. The steps are
    those of the position where the velocity was derived from it. Where what else is noisy is as large as a step, they
    are no staircase any more, but white noise.
    """
    derived, time, run = recording.derived_over, recording.time, recording.run
    values = recording["position" if derived else "velocity"]
    step, noise = quantum(values), motion_noise(recording)
    if not step or noise.filtered is not None or noise.deviation >= step:
        return np.zeros((0, len(values))), np.zeros((0, len(values)))
    course = noise.course
    if course is None or len(course) != len(values):
        course = lanczos_derivative(time, values, max(derived, 1), run)[0]
    place = (np.arange(PLACES) + 0.5) / PLACES
    errors = step * (np.floor(course / step + place[:, None] + _ON_EDGE) + 0.5 - place[:, None]) - course
    if not derived:
        errors += step * (2.0 * (np.arange(1, PLACES + 1) * _GOLDEN % 1.0) - 1.0)[:, None]
        return errors, errors
    slopes = [lanczos_derivative(time, error, derived, run)[1] for error in errors]
    return np.array([mean_velocity(recording, error) for error in errors]), np.array(slopes)


def scatter_of_steps(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    """Return by how much what is left of the rows would differ, were the steps of the sensor elsewhere.

    Once for the same rows: a little other parameters change nothing of this order.

    Args:
        problem: the rows.
        parameters: of the drive, by key, the inertia among them.

    Returns:
        Shape (places, rows); no places where the motion was recorded without steps.
    """
    return problem.integrated(("steps of the sensor",), lambda: _scatter(problem, parameters))


def _scatter(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    recording, drive, bumps = problem.recording, problem.drive, problem.bumps
    cells, velocities = errors_of_steps(recording)
    if not len(cells):
        return np.zeros((0, bumps.count))
    inertia, values = drive.split(parameters)
    pairs = list(zip(values, drive.model.linear, strict=True))
    theta = np.array([value for value, linear in pairs if linear])
    nonlinear = [value for value, linear in pairs if not linear]

    def friction(velocity: Array) -> Array:
        quadrature = Quadrature.of(recording, velocity, bumps.left_out)
        design, offset = drive.regressors(quadrature.recording, nonlinear)
        return np.asarray(bumps.torques(quadrature, (theta @ design + offset)[None])[0])

    with_memory = bool(drive.model.states)
    before = np.zeros(bumps.count) if with_memory else friction(problem.smooth)
    found = []
    for cell, velocity in zip(cells, velocities, strict=True):
        left = -inertia * bumps.momentum(cell)
        if not with_memory:  # where it has one, what the steps do through it is not reckoned with
            change = lanczos_derivative(recording.time, velocity, problem.half_width, recording.run)[0]
            left -= friction(np.where(problem.smooth != 0.0, problem.smooth + change, 0.0)) - before
        found.append(left)
    return np.array(found)
