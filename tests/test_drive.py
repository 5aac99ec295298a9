"""The equation of motion around a model: evaluation, regressors, limits at rest, state space, units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.dimension import INERTIA, Motion, Scales
from fricmodels.drive import Drive, rest_width
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording

RICH = "asymmetric-exponential-stick-slip+cogging+presliding+thermal+inertia-error+sensor-delay"


def recorded(seed: int = 0, samples: int = 200) -> Recording:
    rng = np.random.default_rng(seed)
    time = np.arange(samples) * 1e-2
    velocity = 2 * np.sin(7 * time) + 0.3 * np.sin(31 * time)
    channels = {
        "time": time,
        "velocity": velocity,
        "position": 1 + np.cumsum(velocity) * 1e-2,
        "acceleration": np.gradient(velocity, time),
        "torque": rng.normal(size=samples),
        "load_torque": rng.normal(size=samples),
        "temperature": 20 + time,
    }
    return Recording("made", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))


def values(drive: Drive, seed: int = 0) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    found = {}
    for p in drive.parameters:
        size = (abs(p.declared.initial) or 1.0) * float(rng.uniform(0.5, 1.5))
        found[p.key] = float(np.clip(size, p.declared.lower, p.declared.upper))
    return found


@pytest.mark.parametrize("inertia", [0.0, -1.0, float("nan"), float("inf")])
def test_an_inertia_that_cannot_be_is_refused(inertia: float) -> None:
    with pytest.raises(InputError, match="inertia must be positive and finite"):
        Drive(Model.parse("coulomb-viscous"), inertia)


def test_the_inertia_is_a_parameter_only_where_it_is_not_given() -> None:
    model = Model.parse("coulomb-viscous")
    assert Drive(model, 2.0).keys == ("K_v", "K_c")
    assert Drive(model).keys == ("J", "K_v", "K_c")
    assert Drive(model, motion=Motion.LINEAR).keys == ("M", "K_v", "K_c")
    assert Drive(model, 2.0).split({"K_v": 3.0, "K_c": 4.0})[0] == 2.0


def test_friction_at_round_numbers() -> None:
    part = recorded().with_channels(velocity=np.linspace(-1, 1, 200))
    torque = Drive(Model.parse("coulomb-viscous"), 1.0).friction(part, {"K_v": 2.0, "K_c": 3.0})
    np.testing.assert_allclose(torque, 2 * part.velocity + 3 * np.where(part.velocity >= 0, 1, -1), rtol=1e-15)


def test_a_torque_that_is_constant_is_given_for_every_sample() -> None:
    drive = Drive(Model.parse("coulomb-viscous+torque-offset"), 1.0)
    torque = drive.friction(recorded(), {"K_v": 0.0, "K_c": 0.0, "torque-offset.tau_0": 5.0}, velocity=1.0)
    np.testing.assert_array_equal(torque, np.full(200, 5.0))


@pytest.mark.parametrize("name", [RICH, "two-thirds-power+stribeck+step-change", "coulomb-viscous+joint-compliance"])
def test_regressors_put_together_are_the_friction(name: str) -> None:
    drive, recording = Drive(Model.parse(name), 1.0), recorded()
    chosen = values(drive)
    linear = [chosen[p.key] for p in drive.model_parameters if p.linear]
    nonlinear = [chosen[p.key] for p in drive.model_parameters if not p.linear]
    design, offset = drive.regressors(recording, nonlinear)
    expected = drive.friction(recording, chosen)
    np.testing.assert_allclose(np.array(linear) @ design + offset, expected, rtol=1e-12, atol=1e-12)


def test_the_jacobian_is_what_a_change_of_parameters_makes() -> None:
    drive, recording = Drive(Model.parse("exponential-stick-slip+cogging"), 1.0), recorded()
    chosen = values(drive)
    jacobian = drive.jacobian(recording, chosen)
    for row, key in zip(jacobian, drive.keys, strict=True):
        step = 1e-6 * max(abs(chosen[key]), 1e-3)
        up, down = ({**chosen, key: chosen[key] + side * step} for side in (1, -1))
        slope = (drive.friction(recording, up) - drive.friction(recording, down)) / (2 * step)
        np.testing.assert_allclose(row, slope, rtol=1e-5, atol=1e-6)


def test_the_sticking_interval_is_the_law_at_both_sides_of_rest() -> None:
    drive = Drive(Model.parse("asymmetric-coulomb-viscous+torque-offset"), 1.0)
    chosen = {"K_v1": 1.0, "K_v2": 1.0, "K_c1": 3.0, "K_c2": 2.0, "torque-offset.tau_0": 0.5}
    low, high = drive.sticking_interval(recorded(), chosen)
    np.testing.assert_allclose(low, -1.5, rtol=1e-8)
    np.testing.assert_allclose(high, 3.5, rtol=1e-8)


def test_stick_torque_above_slip_torque_widens_the_sticking_interval() -> None:
    drive = Drive(Model.parse("exponential-stick-slip"), 1.0)
    low, high = drive.sticking_interval(recorded(), {"K_v": 1.0, "K_c": 3.0, "C": 2.0, "B": 10.0})
    np.testing.assert_allclose([low[0], high[0]], [-3.0, 3.0], rtol=1e-6)


def test_a_model_that_needs_a_channel_that_is_missing_is_refused() -> None:
    full = recorded()
    for effect, channel in (("cogging", "position"), ("thermal", "temperature"), ("load-friction", "load_torque")):
        left = {name: array for name, array in full.channels.items() if name != channel}
        recording = Recording("short", full.motion, left, full.run)
        drive = Drive(Model.parse(f"coulomb-viscous+{effect}"), 1.0)
        with pytest.raises(InputError, match=f"needs the channel '{channel}'"):
            drive.friction(recording, values(drive))


exponents = st.integers(-20, 20).map(lambda exponent: 2.0**exponent)


@settings(max_examples=30, deadline=None)
@given(st.tuples(exponents, exponents, exponents, exponents), st.integers(0, 100))
def test_the_same_drive_in_other_units_feels_the_same_friction(sizes: tuple[float, ...], seed: int) -> None:
    """States included: the integration of the memory is free of units, too."""
    scales = Scales(*sizes)
    drive, recording = Drive(Model.parse(RICH), 1.7), recorded(seed)
    chosen = values(drive, seed)
    normalised = dict(zip(drive.keys, np.array(list(chosen.values())) / drive.parameter_scales(scales), strict=True))
    torque = drive.friction(recording, chosen)
    other = drive.scaled(scales).friction(recording.scaled(scales), normalised)
    np.testing.assert_allclose(other * scales.force, torque, rtol=1e-9, atol=1e-9 * float(np.max(np.abs(torque))))
    back = drive.restore(list(normalised.values()), scales)
    np.testing.assert_allclose(back, list(chosen.values()), rtol=1e-12)
    assert drive.scaled(scales).inertia == pytest.approx(1.7 / scales.of(INERTIA), rel=1e-12)


# ---- state space ------------------------------------------------------------------------------------------------


def rate(drive: Drive, state: Mapping[str, float], chosen: Mapping[str, float], given: Mapping[str, float]) -> Any:
    space = drive.state_space()
    function = casadi.Function("rate", [space.x, space.u, space.width], [space.rate])
    x = [*(state[name] for name in space.states), *(chosen[key] for key in drive.keys)]
    return np.array(function(x, [given[name] for name in space.inputs], 1e-9)).ravel()


def test_the_state_space_is_newtons_law() -> None:
    drive = Drive(Model.parse("coulomb-viscous"))
    chosen = {"J": 2.0, "K_v": 3.0, "K_c": 5.0}
    found = rate(drive, {"velocity": 4.0}, chosen, {"motor_torque": 30.0, "load_torque": 1.0})
    np.testing.assert_allclose(found, [(30 - 1 - 12 - 5) / 2, 0, 0, 0], rtol=1e-14)


def test_an_inertia_error_adds_to_the_inertia() -> None:
    """J dω/dt = τ_m − τ_F − ΔJ dω/dt, solved for dω/dt."""
    drive = Drive(Model.parse("coulomb-viscous+inertia-error"), 2.0)
    chosen = {"K_v": 3.0, "K_c": 5.0, "inertia-error.dJ": 0.5}
    found = rate(drive, {"velocity": 4.0}, chosen, {"motor_torque": 30.0, "load_torque": 1.0})
    assert found[0] == pytest.approx((30 - 1 - 12 - 5) / 2.5, rel=1e-14)


def test_acceleration_in_the_rates_of_a_memory_is_the_drives_own() -> None:
    """A link of inertia J_l on a spring: the motor alone is accelerated by what the spring does not take."""
    drive = Drive(Model.parse("coulomb-viscous+joint-compliance"), 2.0)
    chosen = {"K_v": 0.0, "K_c": 0.0, "joint-compliance.J_l": 0.5}
    chosen |= {"joint-compliance.omega_n": 10.0, "joint-compliance.zeta": 0.1}
    state = {"velocity": 0.0, "x": 0.01, "v": 0.2}
    found = rate(drive, state, chosen, {"motor_torque": 3.0, "load_torque": 0.0})
    spring = 100 * 0.01 + 2 * 0.1 * 10 * 0.2
    acceleration = (3.0 - 0.5 * spring) / (2.0 - 0.5)
    np.testing.assert_allclose(found[:3], [acceleration, 0.2, acceleration - spring], rtol=1e-13)


def test_position_is_an_input() -> None:
    drive = Drive(Model.parse("coulomb-viscous+cogging"), 1.0)
    assert drive.state_space().inputs == ("position", "motor_torque", "load_torque")


def test_the_width_of_rest_follows_the_speed() -> None:
    assert rest_width(recorded()) == pytest.approx(1e-6 * np.max(np.abs(recorded().velocity)))
    assert rest_width(recorded().with_channels(velocity=np.zeros(200))) > 0


def test_a_known_delay_is_taken_out_of_the_record() -> None:
    time = np.arange(400) * 0.01
    channels = {"time": time, "torque": np.sin(3 * time), "velocity": np.cos(3 * time)}
    recording = Recording("late", Motion.ROTARY, channels, np.zeros(400, dtype=np.int64))
    drive = Drive(Model.parse("coulomb-viscous+sensor-delay"), 1.0)
    values = {"K_v": 0.1, "K_c": 1.0, "sensor-delay.T": 0.2}
    timed, left = drive.timed(recording, values)
    np.testing.assert_allclose(timed.torque[20:], recording.torque[:-20])
    assert left == {**values, "sensor-delay.T": 0.0}
    assert drive.timed(recording, left) == (recording, left)
    plain = Drive(Model.parse("coulomb-viscous"), 1.0)
    assert plain.timed(recording, {"K_v": 0.1, "K_c": 1.0})[0] is recording
