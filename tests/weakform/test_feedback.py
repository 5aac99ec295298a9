"""What comes back through a predicted velocity: its derivative against differences of simulations and of rows."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.kernels.small import invert, reduced
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.signals.lanczos import DEGREE, _fit_windows, fit_stretch
from fricmodels.simulation import simulate, simulated_velocity
from fricmodels.weakform.feedback import _axes, _left_by, feedback
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.prepared import prepared
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.solve import solve
from fricmodels.weakform.tangent import tangents

DRIVES = {
    "coulomb-viscous": {"J": 0.05, "K_v": 0.1, "K_c": 0.4},
    "asymmetric-coulomb-viscous": {"J": 0.05, "K_v1": 0.1, "K_v2": 0.2, "K_c1": 0.4, "K_c2": 0.3},
    "exponential-stick-slip": {"J": 0.05, "K_v": 0.1, "K_c": 0.45, "C": 0.4, "B": 2.0},
}


def recorded(law: str, amplitude: float) -> tuple[Drive, dict[str, float], Recording]:
    drive, values = Drive(Model.parse(law)), DRIVES[law]
    time = 0.002 * np.arange(3000)
    torque = amplitude * np.sin(2.0 * time) + 0.5 * amplitude * np.sin(7.0 * time + 1.0)
    return drive, values, prepared(simulate(drive, values, time, torque, noise=0.2, seed=1))


@pytest.mark.parametrize("amplitude", [0.5, 4.0], ids=["rests", "turns"])
@pytest.mark.parametrize("law", DRIVES)
def test_the_tangent_is_the_derivative_of_the_simulation(law: str, amplitude: float) -> None:
    drive, values, recording = recorded(law, amplitude)
    simulated = simulated_velocity(drive, values, recording)
    assert (np.mean(simulated == 0.0) > 0.05) == (amplitude < 1.0)
    for key, found in zip(drive.keys, tangents(drive, values, recording, simulated), strict=True):
        step = 1e-6 * values[key]
        ends = [simulated_velocity(drive, {**values, key: values[key] + s}, recording) for s in (-step, step)]
        wanted = (ends[1] - ends[0]) / (2.0 * step)
        assert np.linalg.norm(found - wanted) < 0.05 * np.linalg.norm(wanted), key


def test_what_a_change_of_the_velocity_leaves_in_the_rows() -> None:
    """At the velocity that a model predicts; a smoothed one has no jumps of the acceleration."""
    drive, values, recording = recorded("coulomb-viscous", 4.0)
    simulated = simulated_velocity(drive, values, recording)
    problem = WeakFormProblem.of(drive, recording, values).along(simulated, simulated == 0.0)
    found = solve(problem, Plan(), timing=False)
    moving = 1e-3 * values["K_c"] * tangents(drive, values, recording, simulated)[2]

    def left(velocity: Array) -> Array:
        other = replace(problem, smooth=velocity, quadrature=Quadrature.of(recording, velocity, problem.resting))
        friction = drive.friction(other.points, found.parameters)
        return np.asarray(other.driving - other.integrals(friction[None])[0])

    wanted = left(problem.smooth + moving) - left(problem.smooth - moving)
    got = 2.0 * _left_by(found, moving[None])[0]
    assert np.linalg.norm(got - wanted) < 0.03 * np.linalg.norm(wanted)


def test_nothing_comes_back_from_a_velocity_that_does_not_change() -> None:
    drive, values, recording = recorded("coulomb-viscous", 2.0)
    found = solve(WeakFormProblem.of(drive, recording, values), Plan(), timing=False)
    grown = feedback(found, np.zeros((3, len(recording))), lambda _: found.values)
    np.testing.assert_array_equal(grown, np.eye(3))


def test_parameters_of_any_size_are_seen() -> None:
    """An inertia of some 1e-6 kg m² beside a speed of some rad/s: its variance is 1e-12 of the other's, and counts."""
    spread = np.diag([1e-12, 1.0, 1e6])
    correlation = np.array([[1.0, 0.5, 0.1], [0.5, 1.0, -0.3], [0.1, -0.3, 1.0]])
    root, back = _axes(spread @ correlation @ spread)
    np.testing.assert_allclose(back @ root, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(root @ root.T / np.outer(np.diag(spread), np.diag(spread)), correlation, atol=1e-12)


def test_small_matrices() -> None:
    rng = np.random.default_rng(3)
    columns = rng.standard_normal((6, 50)) * 10.0 ** np.arange(-9, 9, 3)[:, None]
    gram, right = columns @ columns.T, columns @ rng.standard_normal(50)
    size, inverse = np.empty(6), np.empty((6, 6))
    assert invert(gram, 1e-280, size, inverse) > 0.0
    np.testing.assert_allclose(size, np.linalg.norm(columns, axis=1))
    np.testing.assert_allclose((gram @ inverse) * size / size[:, None], np.eye(6), atol=1e-12)
    free, last, scale = np.array([0, 2, 3]), np.array([1, 5]), np.array([2.0, 3.0])
    inner = np.linalg.inv(gram[np.ix_(free, free)])
    cross = gram[np.ix_(free, last)] * scale
    matrix, gradient = np.empty((2, 2)), np.empty(2)
    reduced(gram, right, inner, free, last, scale, 0.0, matrix, gradient)
    wanted = gram[np.ix_(last, last)] * np.outer(scale, scale) - cross.T @ inner @ cross
    np.testing.assert_allclose(matrix, wanted, rtol=1e-6)
    np.testing.assert_allclose(gradient, right[last] * scale - cross.T @ inner @ right[free], rtol=1e-6)
    assert invert(np.ones((2, 2)), 1e-280, np.empty(2), np.empty((2, 2))) == 0.0


@pytest.mark.parametrize("half_width", [1, 4, 20])
def test_the_ends_of_even_samples_are_those_of_any_samples(half_width: int) -> None:
    time = 3.0 + 0.01 * np.arange(200)
    values = 5.0 + np.sin(4.0 * time)
    ends = np.r_[0:half_width, 200 - half_width : 200]
    wanted = _fit_windows(time, values, 2 * half_width + 1, DEGREE, ends)
    for got, one in zip(fit_stretch(time, values, half_width), wanted, strict=True):
        np.testing.assert_allclose(got[ends], one, rtol=1e-9, atol=1e-10)


def test_a_recording_is_prepared_once_and_let_go() -> None:
    time = 0.01 * np.arange(400)
    channels = {"time": time, "torque": np.cos(time), "velocity": np.sin(time)}
    recording = Recording("arm", Motion.ROTARY, channels, np.zeros(400, dtype=np.int64))
    assert prepared(recording) is prepared(recording)
    assert prepared(replace(recording)) is not prepared(recording)
    known = weakref.ref(recording)
    del recording
    gc.collect()
    assert known() is None
