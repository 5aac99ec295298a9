r"""What the steps of a sensor do to an estimate: its rows are evaluated anew with the steps elsewhere.

The error of a staircase goes with the motion. Under a motion that repeats itself it is the same in every cycle: least
squares takes it up, the residual does not show it, and no long-run variance does. But how large it is, is known: the
same staircase, moved by a part of its step, makes another error of the same kind. To first order each one moves the
estimate by

.. math:: \delta\theta = (X^T X)^{-1} X^T \left(-J\,\delta\!\int\!\varphi\,d\omega - \delta X\,\theta\right)

and the mean of :math:`\delta\theta\,\delta\theta^T` over evenly spaced places of the staircase is their covariance.

The steps of the torque's sensor do the same to ∫φ τ_m dt: at constant speeds it is rounded the same way every time.

A staircase of the velocity has an offset besides, which no sample shows: values are rounded up, down or to the nearest
step, of a scale whose zero may lie anywhere within a step. It is taken to lie anywhere within a step either way.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative, motion_noise, quantum
from fricmodels.signals.switched import torque_noise
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.test_functions import mean_velocity

PLACES = 8
_PLACE = (np.arange(PLACES) + 0.5)[:, None] / PLACES
"""Places of the staircase, evenly spaced within a step."""
_ON_EDGE = 1e-9
"""Share of a step: what lies so near below an edge lies on it but for rounding, as means of few rounded values do."""
_LONGER = 2.5
"""Times as long as those beside it that a step lasts that is only passed: from rest, evenly faster, it is 2.41."""
_EXCERPT = 2048
"""Samples that show whether a torque comes in steps at all."""
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Multiples of it, less whole numbers, are spread evenly: offsets that do not go with the places."""


@once
def errors_of_steps(recording: Recording) -> tuple[Array, Array]:
    """Return errors that the steps of the sensor of the motion may have made, shape (places, N); none without steps.

    Of the velocity whose changes are the momentum, and of the velocity that is smoothed for the friction. The steps are
    those of the position where the velocity was derived from it. Where what else is noisy is as large as a step, they
    are no staircase any more, but white noise.
    """
    derived, errors = recording.derived_over, errors_of_staircase(recording)
    if not len(errors):
        return errors, errors
    if not derived:
        offsets = 2.0 * (np.arange(1, PLACES + 1) * _GOLDEN % 1.0) - 1.0
        errors = errors + quantum(recording.velocity) * offsets[:, None]
        return errors, errors
    slopes = [lanczos_derivative(recording.time, error, derived, recording.run)[1] for error in errors]
    return np.array([mean_velocity(recording, error) for error in errors]), np.array(slopes)


@once
def errors_of_staircase(recording: Recording) -> Array:
    """Return errors that the steps of the channel that tells the motion may have made, without an offset, (places, N).

    None where it has no steps, or is as noisy as they are.
    """
    derived, time, run = recording.derived_over, recording.time, recording.run
    values = recording["position" if derived else "velocity"]
    step, noise = quantum(values), motion_noise(recording)
    if not step or noise.filtered is not None or noise.deviation >= step:
        return np.zeros((0, len(values)))
    course = noise.course
    if course is None or len(course) != len(values):
        course = lanczos_derivative(time, values, max(derived, 1), run)[0]
    return _rounded_elsewhere(course, step)


def _rounded_elsewhere(course: Array, step: float) -> Array:
    """Return the errors of a staircase at evenly spaced places of it, shape (places, N)."""
    return np.asarray(step * (np.floor(course / step + _PLACE + _ON_EDGE) + 0.5 - _PLACE) - course)


@once
def errors_of_torque_steps(recording: Recording) -> Array:
    """Return errors that the steps of the torque's sensor may have made, shape (places, N); none without steps.

    Where it is as noisy as its steps they are white noise; a torque that is switched is a command, and exact. A torque
    that stays in a step, as at a constant speed, may be anywhere within it, each time anew.
    """
    none = np.zeros((0, len(recording)))
    if not quantum(recording.torque[:_EXCERPT]):
        return none
    noise = torque_noise(recording)
    if noise.course is None or len(noise.course) != len(recording):
        return none
    changed = np.abs(np.diff(recording.torque, prepend=recording.torque[:1])) > 0.5 * noise.step
    within = np.cumsum(changed, dtype=np.int64)
    anywhere = noise.step * ((_PLACE + within * _GOLDEN) % 1.0 - 0.5)
    return np.where(_stays(recording.torque, within), anywhere, _rounded_elsewhere(noise.course, noise.step))


def _stays(values: Array, within: Index) -> Mask:
    """Mark samples of a step that is not passed: it ends where it began, or lasts far longer than those beside it.

    Args:
        values: quantised, shape (N,).
        within: number of the step that each sample lies in, shape (N,), from 0 on.
    """
    length = np.bincount(within)
    level = values[np.cumsum(length) - 1]
    change = np.sign(np.diff(level))
    passed = np.r_[False, change[1:] * change[:-1] > 0.0, False] if len(level) > 1 else np.zeros(1, dtype=np.bool_)
    beside = np.maximum(np.r_[0, length[:-1]], np.r_[length[1:], 0])
    return np.asarray((~passed | (length > _LONGER * beside))[within])


def scatter_of_steps(problem: WeakFormProblem, parameters: Mapping[str, float]) -> tuple[Array, Array]:
    """Return by how much what is left of the rows would differ, were the steps of the sensors elsewhere.

    Once for the same rows: a little other parameters change nothing of this order.

    Args:
        problem: the rows.
        parameters: of the drive, by key, the inertia among them.

    Returns:
        Of the motion and of the torque, (places, rows) each; no places where it was recorded without steps.
    """
    return (
        problem.integrated(("steps of the motion",), lambda: _scatter(problem, parameters)),
        scatter_of_torque(problem),
    )


def scatter_of_torque(problem: WeakFormProblem) -> Array:
    """Return by how much the driving torque of the rows would differ, were the steps of its sensor elsewhere.

    Returns:
        Shape (places, rows); no places where it was recorded without steps.
    """
    return problem.integrated(("steps of the torque", problem.held), lambda: _scatter_of_torque(problem))


def _scatter_of_torque(problem: WeakFormProblem) -> Array:
    errors, cell = errors_of_torque_steps(problem.recording), problem.quadrature.cell
    if not len(errors):
        return np.zeros((0, problem.test_functions.count))
    if problem.held:
        return np.asarray(problem.test_functions.of_cells(errors * problem.quadrature.moving_time))
    at_points = np.concatenate([errors, errors[:, cell], errors[:, cell + 1]], axis=1)
    return np.asarray(problem.test_functions.torques(problem.quadrature, at_points))


def _scatter(problem: WeakFormProblem, parameters: Mapping[str, float]) -> Array:
    recording, drive, test_functions = problem.recording, problem.drive, problem.test_functions
    cells, velocities = errors_of_steps(recording)
    if not len(cells):
        return np.zeros((0, test_functions.count))
    inertia, values = drive.split(parameters)
    pairs = list(zip(values, drive.model.linear, strict=True))
    theta = np.array([value for value, linear in pairs if linear])
    nonlinear = [value for value, linear in pairs if not linear]

    def friction(velocity: Array) -> Array:
        quadrature = Quadrature.of(recording, velocity, test_functions.left_out)
        design, offset = drive.regressors(quadrature.recording, nonlinear)
        return np.asarray(test_functions.torques(quadrature, (theta @ design + offset)[None])[0])

    with_memory = bool(drive.model.states)
    before = np.zeros(test_functions.count) if with_memory else friction(problem.smooth)
    found = []
    for cell, velocity in zip(cells, velocities, strict=True):
        left = -inertia * test_functions.momentum(cell)
        if not with_memory:  # where it has one, what the steps do through it is not reckoned with
            change = lanczos_derivative(recording.time, velocity, problem.half_width, recording.run)[0]
            left -= friction(np.where(problem.smooth != 0.0, problem.smooth + change, 0.0)) - before
        found.append(left)
    return np.array(found)
