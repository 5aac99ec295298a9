"""Effects against their formulas written out by hand, and against what the literature says of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.recording import Recording

Array = NDArray[np.float64]


def recorded(samples: int = 500, **channels: Array) -> Recording:
    rng = np.random.default_rng(0)
    made = {name: rng.uniform(-3, 3, samples) for name in ("torque", "velocity", "position", "acceleration")}
    made |= {"load_torque": rng.uniform(-3, 3, samples), "temperature": rng.uniform(20, 60, samples)}
    made |= {"torque_rate": rng.uniform(-3, 3, samples), "time": np.arange(samples) * 1e-3}
    made |= {"other.x": np.append(rng.uniform(-3, 3, samples - 1), 0.0)}
    return Recording("made", Motion.ROTARY, {**made, **channels}, np.zeros(samples, dtype=np.int64))


def torque(effect: str, parameters: dict[str, float], recording: Recording) -> Array:
    drive = Drive(Model.only(load().effects[effect]()), 1.0)
    values = {p.key: parameters.get(p.declared.symbol, 0.0) for p in drive.model_parameters}
    return drive.friction(recording, values)


WAVES = {"a": 2.0, "b": 3.0, "a_2": -0.5, "b_2": 0.7, "k": 7.5}


def waves(position: Array) -> Array:
    return (
        2 * np.cos(7.5 * position)
        + 3 * np.sin(7.5 * position)
        - 0.5 * np.cos(15 * position)
        + 0.7 * np.sin(15 * position)
    )


FORMULAS: dict[str, tuple[dict[str, float], Callable[[Any, Array], Array]]] = {
    "asymmetry": ({"c": 2.0, "d": 3.0}, lambda r, s: 2 + 3 * np.abs(r["velocity"])),
    "torque-offset": ({"tau_0": 2.0}, lambda r, s: np.full(len(r), 2.0)),
    "stribeck": (
        {"F_s": 2.0, "omega_s": 0.7, "delta": 1.5},
        lambda r, s: 2 * s * np.exp(-((np.abs(r["velocity"]) / 0.7) ** 1.5)),
    ),
    "nonlinear-viscous": (
        {"a": 2.0, "b": 3.0},
        lambda r, s: s * (2 * np.sqrt(np.abs(r["velocity"])) + 3 * r["velocity"] ** 2),
    ),
    "load-friction": ({"mu": 0.3}, lambda r, s: 0.3 * np.abs(r["load_torque"]) * s),
    "directional-efficiency": (
        {"mu_d": 0.3, "mu_b": 0.5},
        lambda r, s: np.where(r["load_torque"] * r["velocity"] >= 0, 0.3, 0.5) * np.abs(r["load_torque"]) * s,
    ),
    "torque-gain": ({"g": 0.2}, lambda r, s: -0.2 * r["torque"]),
    "inertia-error": ({"dJ": 0.2}, lambda r, s: 0.2 * r["acceleration"]),
    "gravity": ({"a": 2.0, "b": 3.0}, lambda r, s: 2 * np.cos(r["position"]) + 3 * np.sin(r["position"])),
    "gravity-friction": ({"c": 2.0, "phi": 0.3}, lambda r, s: 2 * np.abs(np.sin(r["position"] - 0.3)) * s),
    "stiffness": ({"k": 2.0, "tau_0": 3.0}, lambda r, s: 2 * r["position"] + 3),
    "cogging": (
        WAVES,
        lambda r, s: waves(r["position"]),
    ),
    "position-friction": (
        WAVES,
        lambda r, s: s * waves(r["position"]),
    ),
    "torque-ripple": (
        WAVES,
        lambda r, s: r["torque"] * waves(r["position"]),
    ),
    "sensor-delay": ({"T": 0.2}, lambda r, s: 0.2 * r["torque_rate"]),
    "thermal": (
        {"a": 0.2, "b": 0.3, "theta_v": 20.0},
        lambda r, s: 0.2 * 20 * (1 - np.exp(-r["temperature"] / 20)) * r["velocity"] + 0.3 * s * r["temperature"],
    ),
    "drift": (
        {"a": 0.2, "b": 0.3, "T": 0.5},
        lambda r, s: (0.2 * r["velocity"] + 0.3 * s) * 0.5 * (1 - np.exp(-r["time"] / 0.5)),
    ),
    "other": ({"c": 2.0}, lambda r, s: 2 * r["other.x"]),
    "other-friction": ({"c": 2.0, "d": 3.0}, lambda r, s: 2 * r["other.x"] + 3 * np.sign(r["other.x"])),
    "other-gravity": ({"a": 2.0, "b": 3.0}, lambda r, s: 2 * np.cos(r["other.x"]) + 3 * np.sin(r["other.x"])),
    "chain-gravity": (
        {"a": 2.0, "b": 3.0, "c": 3.0, "d": -2.0},  # parallel axes
        lambda r, s: 2 * np.cos(r["position"] + r["other.x"]) + 3 * np.sin(r["position"] + r["other.x"]),
    ),
    "other-inertia": ({"c": 2.0}, lambda r, s: 2 * np.gradient(r["other.x"], r.time)),
    "proximal-coupling": ({"c": 2.0, "a": 3.0, "b": 5.0}, lambda r, s: coupled_links(r, 2.0, 3.0, 5.0)),
    "run-offset": ({"tau_0": 2.0}, lambda r, s: np.where(r.run == 0, 2.0, 0.0)),
    "step-change": ({"c": 2.0, "d": 3.0, "t_0": 0.2}, lambda r, s: np.where(r["time"] >= 0.2, 2 * s + 3, 0)),
}


def coupled_links(recording: Recording, c: float, a: float, b: float) -> Array:
    """Return what a link feels of the joint before, with both angles by one amplitude and phase."""
    rate, speed, angle = np.gradient(recording["other.x"], recording.time), recording["other.x"], recording["position"]
    size, phase = np.hypot(a, b), np.arctan2(b, a)
    return c * rate + size * (np.cos(angle - phase) * rate + np.sin(angle - phase) * speed**2)


@pytest.mark.parametrize("effect", FORMULAS)
def test_torque_is_the_formula_written_by_hand(effect: str) -> None:
    parameters, formula = FORMULAS[effect]
    recording = replace(recorded(), run=np.arange(500) // 250) if effect == "run-offset" else recorded()
    expected = formula(recording, np.where(recording.velocity >= 0, 1.0, -1.0))
    np.testing.assert_allclose(torque(effect, parameters, recording), expected, rtol=1e-12, atol=1e-12)


def test_every_effect_stands_in_one_of_these_tests() -> None:
    own = {name for name in load().effects if load().effects.entry(name).distribution == "fricmodels"}
    with_memory = {"presliding", "frictional-lag", "rising-stiction", "backlash", "joint-compliance"}
    assert own == set(FORMULAS) | with_memory


@pytest.mark.parametrize("effect", ["torque-offset", "gravity", "cogging", "inertia-error", "other", "run-offset"])
def test_what_is_no_friction_does_not_know_the_direction(effect: str) -> None:
    recording = recorded()
    back = recording.with_channels(velocity=-recording.velocity)
    parameters = FORMULAS[effect][0]
    np.testing.assert_array_equal(torque(effect, parameters, recording), torque(effect, parameters, back))


@pytest.mark.parametrize(
    "effect", ["stribeck", "nonlinear-viscous", "load-friction", "gravity-friction", "position-friction", "thermal"]
)
def test_friction_turns_round_with_the_motion(effect: str) -> None:
    recording = recorded()
    back = recording.with_channels(velocity=-recording.velocity)
    parameters = FORMULAS[effect][0]
    np.testing.assert_allclose(torque(effect, parameters, recording), -torque(effect, parameters, back), rtol=1e-12)


def test_the_stribeck_curve_at_its_own_speed() -> None:
    """At ω_s the extra friction has fallen to 1/e whatever the exponent; at rest it is whole; far above it is gone."""
    speeds = np.array([0.0, 0.7, -0.7, 70.0])
    for delta in (0.5, 1.0, 2.0):
        part = recorded(4, velocity=speeds)
        found = torque("stribeck", {"F_s": 2.0, "omega_s": 0.7, "delta": delta}, part)
        np.testing.assert_allclose(found[:3], [2.0, 2 / np.e, -2 / np.e], rtol=1e-5)
        assert found[3] < 2 * np.exp(-(100**delta)) + 1e-12


def dahl_loop(amplitude: float, x_s: float, frequency: float = 1.0) -> tuple[Array, Array]:
    """Return position and the whole elastic friction F z (F = 1) over three cycles of a sine."""
    time = np.linspace(0, 3 / frequency, 60_001)
    q = amplitude * np.sin(2 * np.pi * frequency * time)
    velocity = np.gradient(q, time)
    part = recorded(60_001, time=time, position=q, velocity=velocity)
    left = torque("presliding", {"F_1": 1.0, "F_2": 1.0, "x_s": x_s}, part)
    return q, left + np.where(velocity >= 0, 1.0, -1.0)


def test_the_dahl_loop_closes_and_encloses_the_work_of_the_textbook() -> None:
    """Between ±A: z = 1 − (1 + z_A) exp(−(q + A)/x_s) with z_A = tanh(A/x_s), so the loop's area is 4 (A − x_s z_A)."""
    amplitude = 0.05
    for x_s in (0.005, 0.02, 0.05):
        q, friction = dahl_loop(amplitude, x_s)
        last = slice(40_000, None)
        assert friction[40_000] == pytest.approx(friction[-1], abs=5e-4)
        area = float(np.trapezoid(friction[last], q[last]))
        expected = 4 * (amplitude - x_s * np.tanh(amplitude / x_s))
        assert area == pytest.approx(expected, rel=2e-3)
        assert np.max(friction[last]) == pytest.approx(np.tanh(amplitude / x_s), rel=2e-3)


def test_the_dahl_loop_does_not_know_the_rate() -> None:
    _, slow = dahl_loop(0.05, 0.02, frequency=0.1)
    _, fast = dahl_loop(0.05, 0.02, frequency=10.0)
    np.testing.assert_allclose(fast, slow, atol=1e-5)


def test_small_dahl_motion_is_a_spring() -> None:
    """For A ≪ x_s friction is F q/x_s: stiffness F/x_s, no loss."""
    q, friction = dahl_loop(1e-4, 1.0)
    np.testing.assert_allclose(friction, q, atol=2e-6)


def test_a_longer_rest_gives_a_higher_breakaway() -> None:
    """After a rest of t the bond has aged to 1 − exp(−t/T), and sliding over x_s wears it off."""
    rests, T, x_s = np.array([0.1, 0.5, 2.0]), 0.5, 1e-3
    peaks = []
    for rest in rests:
        time = np.linspace(0, rest + 1, 20_001)
        part = recorded(20_001, time=time, velocity=np.where(time > rest, 1.0, 0.0))
        found = torque("rising-stiction", {"F": 2.0, "T": T, "x_s": x_s}, part)
        peaks.append(found[time <= rest][-1])
        assert abs(found[-1]) < 2 * 3 * x_s / T
    np.testing.assert_allclose(peaks, 2 * (1 - np.exp(-rests / T)), rtol=2e-3)


@pytest.mark.parametrize("r", [0.0, 0.5, 1.0])
def test_at_constant_speed_friction_that_lags_is_that_of_the_speed(r: float) -> None:
    time = np.linspace(0, 1, 5001)
    part = recorded(5001, time=time, velocity=np.full(5001, -2.0))
    found = torque("frictional-lag", {"F_s": 2.0, "K": 3.0, "omega_s": 1.0, "T": 0.01, "r": r}, part)
    np.testing.assert_allclose(found, -2 * np.exp(-2), rtol=1e-12)


def test_a_compliant_joint_far_below_its_resonance_is_rigid() -> None:
    """Nothing is left but J_l ω²/ω_n² of the inertia torque."""
    time = np.linspace(0, 20, 40_001)
    acceleration = np.sin(time)
    part = recorded(40_001, time=time, velocity=-np.cos(time), acceleration=acceleration)
    found = torque("joint-compliance", {"J_l": 1.0, "omega_n": 50.0, "zeta": 0.3}, part)
    late = time > 5
    np.testing.assert_allclose(found[late], acceleration[late] / (50.0**2 - 1), atol=3e-5)


def test_a_change_that_ends_much_later_is_a_straight_line() -> None:
    recording = recorded()
    side, time = np.sign(recording.velocity), recording.time
    slow = torque("drift", {"a": 0.2, "b": 0.3, "T": 1e6}, recording)
    np.testing.assert_allclose(slow, (0.2 * recording.velocity + 0.3 * side) * time, rtol=1e-6, atol=1e-9)
