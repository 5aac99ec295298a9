"""A part on a spring that swings already when a run begins: its first states are found from the torque."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion, Scales
from fricmodels.drive import Drive, rest_width
from fricmodels.effects import JointCompliance
from fricmodels.expressions import Expression
from fricmodels.kernels import Scan
from fricmodels.memory import memory_step, step_with_beginnings
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.term import Parameters, Signals

Array = NDArray[np.float64]
J, J_L, OMEGA, ZETA, K_V, K_C = 2.0, 0.8, 40.0, 0.04, 0.5, 3.0
NAME = "coulomb-viscous+joint-compliance"
TRUTH = {
    "J": J,
    "K_v": K_V,
    "K_c": K_C,
    "joint-compliance.J_l": J_L,
    "joint-compliance.omega_n": OMEGA,
    "joint-compliance.zeta": ZETA,
}
WAVES = ((4.0, 0.31, 0.0), (3.0, 0.77, 1.0), (2.0, 1.43, 2.0), (1.0, 2.71, 3.0))


def motion(time: Array) -> tuple[Array, Array]:
    """Return a velocity and its exact derivative."""
    velocity = sum(a * np.sin(2 * np.pi * f * time + p) for a, f, p in WAVES)
    acceleration = sum(2 * np.pi * f * a * np.cos(2 * np.pi * f * time + p) for a, f, p in WAVES)
    return np.asarray(velocity), np.asarray(acceleration)


def swinging(first: list[tuple[float, float]], seconds: float = 8.0, rate: float = 500.0) -> tuple[Recording, Array]:
    """Return a recording, a run for each first twist and rate of twist, and the true states."""
    time = np.arange(int(seconds * rate)) / rate
    velocity, acceleration = motion(time)
    torques, states = [], []
    for begin in first:

        def rates(t: float, z: Array) -> list[float]:
            return [z[1], float(motion(np.array([t]))[1][0]) - OMEGA**2 * z[0] - 2 * ZETA * OMEGA * z[1]]

        z = solve_ivp(rates, (0.0, time[-1]), begin, t_eval=time, method="DOP853", rtol=1e-9, atol=1e-12).y
        spring = OMEGA**2 * z[0] + 2 * ZETA * OMEGA * z[1]
        friction = K_V * velocity + K_C * np.sign(velocity)
        torques.append(J * acceleration + friction + J_L * (spring - acceleration))
        states.append(z)
    runs = len(first)
    channels = {
        "time": np.concatenate([time + 2 * seconds * run for run in range(runs)]),
        "torque": np.concatenate(torques),
        "velocity": np.tile(velocity, runs),
        "acceleration": np.tile(acceleration, runs),
    }
    run = np.repeat(np.arange(runs), len(time))
    return Recording("swinging", Motion.ROTARY, channels, run), np.concatenate(states, axis=1)


def found(recording: Recording, inertia: float | None = J) -> tuple[Array, ...]:
    drive = Drive(Model.parse(NAME), inertia)
    return drive.states(recording, drive.split(TRUTH)[1])


@pytest.mark.parametrize("inertia", [pytest.param(J, marks=pytest.mark.long), None])
def test_the_states_are_those_of_the_link_from_the_first_sample_on(inertia: float | None) -> None:
    """In each of two runs that begin otherwise, whether the inertia is known or not."""
    recording, true = swinging([(0.02, -0.9), (-0.015, 0.4)])
    for state, expected in zip(found(recording, inertia), true, strict=True):
        assert np.max(np.abs(state - expected)) < 0.01 * np.max(np.abs(expected))


def test_without_the_torque_the_swing_is_missed() -> None:
    """What the motion alone tells is wrong by the size of the swing: the test above could fail."""
    recording, true = swinging([(0.02, -0.9)])
    model = Model.parse(NAME)
    drive = Drive(model, J)
    x, _ = drive.memory(recording, rest_width(recording))(drive.split(TRUTH)[1])
    assert np.max(np.abs(x - true[0])) > 0.5 * np.max(np.abs(true[0]))


def test_the_first_states_scale_with_the_units() -> None:
    recording, _ = swinging([(0.02, -0.9)])
    scales = Scales(0.1, 3.0, 7.0)
    scaled = recording.scaled(scales)
    drive = Drive(Model.parse(NAME), J)
    own = drive.scaled(scales)
    values = drive.split(TRUTH)[1] / own.parameter_scales(scales)
    for state, other, declared in zip(found(recording), own.states(scaled, values), drive.model.states, strict=True):
        np.testing.assert_allclose(other * scales.of(declared.dimension), state, rtol=1e-6, atol=1e-9)


def test_a_blow_that_no_motion_makes_is_no_beginning() -> None:
    """The torque of a beginning is no more than the states make by the motion anywhere in the run."""
    recording, _ = swinging([(5.0, 0.0)])
    x, v = found(recording)
    spring = OMEGA**2 * x + 2 * ZETA * OMEGA * v
    late = recording.time > 6.0
    assert np.max(np.abs(spring)) < 3 * np.max(np.abs(spring[late]))


@pytest.mark.long
def test_the_parameters_come_out_and_nothing_is_left() -> None:
    """A swing of the size of the inertia torque: without its beginning ζ came out 2.6 times too large."""
    recording, _ = swinging([(0.02, -0.9)], seconds=16.0)
    rng = np.random.default_rng(5)
    velocity = recording.velocity + 1e-3 * rng.standard_normal(len(recording))
    channels = {"time": recording.time, "torque": recording.torque, "velocity": velocity}
    measured = Recording("measured", Motion.ROTARY, channels, recording.run)
    comparison = compare(measured, NAME, J)
    estimate = comparison.estimate.parameters
    for key, share in (("J_l", 0.02), ("omega_n", 0.005), ("zeta", 0.05)):
        key = f"joint-compliance.{key}"
        assert estimate[key] == pytest.approx(TRUTH[key], rel=share)
    assert comparison.errors.held_out_percent < 1.5 * comparison.noise_floor_percent + 0.5


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.999999, 1.0, 1.000001, 1.8])
def test_a_step_of_the_twist_is_exact(zeta: float) -> None:
    """Against the matrix exponential, with a velocity that changes linearly; under, at and over critical damping."""
    import casadi

    model = Model.only(JointCompliance())
    step = memory_step(model)
    h, omega, slope = 0.013, 70.0, 4.0
    needed = [name for name in model.signals if name in model.needs]
    ends = [{"velocity": 1.0, "acceleration": 0.0}, {"velocity": 1.0 + slope * h, "acceleration": 0.0}]
    given = [h, *(end[name] for end in ends for name in needed)]
    begin = np.array([0.01, -0.3])
    constants = [{"J_l": 1.0, "omega_n": omega, "zeta": zeta}[p.symbol] for p in JointCompliance.parameters]
    after = np.array(step(begin, casadi.DM(given), casadi.DM([*constants, 1e-9]))[0]).ravel()
    matrix = np.array([[0, 1, 0], [-(omega**2), -2 * zeta * omega, 1], [0, 0, 0]])
    exact = expm(matrix * h) @ [*begin, slope]
    np.testing.assert_allclose(after, exact[:2], rtol=1e-5, atol=1e-12)


def test_what_a_beginning_leaves_is_the_difference_of_two_motions() -> None:
    """Beside a state of another term: R of the extended step against the plain one, begun a unit higher."""
    model = Model.parse("coulomb-viscous+presliding+joint-compliance")
    plain, extended = Scan(memory_step(model)), Scan(step_with_beginnings(model))
    rng = np.random.default_rng(3)
    rows = np.column_stack([rng.uniform(0.001, 0.02, 40), rng.standard_normal((40, plain.n_inputs - 1))])
    constants = [*rng.uniform(0.5, 2.0, plain.n_constants - 1), 1e-9]
    count = plain.n_states
    begin = np.linspace(0.1, 0.3, count)
    _, together, _ = extended([*begin, 1.0, 0.0, 0.0, 1.0], rows, constants)
    _, without, _ = plain(begin, rows, constants)
    np.testing.assert_allclose(together[:, :count], without, rtol=1e-12, atol=1e-15)
    assert [state.symbol for state in model.states][-2:] == ["x", "v"]
    for i in range(2):
        moved = begin.copy()
        moved[count - 2 + i] += 1.0
        _, states, _ = plain(moved, rows, constants)
        left = together[:, count + 2 * i : count + 2 * i + 2]
        np.testing.assert_allclose(left, (states - without)[:, -2:], rtol=1e-9, atol=1e-12)


def test_an_unknown_beginning_of_what_is_not_linear_is_refused() -> None:
    class Bent(JointCompliance):
        """A spring that grows stiffer."""

        name = "bent"

        def discrete_step(self, s: Signals, later: Signals, h: Expression, p: Parameters) -> Mapping[str, Expression]:
            after = super().discrete_step(s, later, h, p)
            return {**after, "v": after["v"] - h * s.x**3}

    with pytest.raises(TypeError, match="'bent' have unknown first values, but are not linear"):
        step_with_beginnings(Model.only(Bent()))
