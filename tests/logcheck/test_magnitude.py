"""A torque that was recorded without its sign."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.logcheck import Severity, findings
from fricmodels.recording import Recording


def drive(*, gravity: float = 0.0, coulomb: float = 0.3, seed: int = 0, samples: int = 8000) -> Recording:
    """Return an arm with inertia, friction and gravity, moved by three sines."""
    rng = np.random.default_rng(seed)
    time = 2e-3 * np.arange(samples)
    rates, sizes, phases = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0]), rng.uniform(0, 6, 3)
    angle = np.outer(time, rates) + phases
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / rates)
    torque = 0.05 * np.cos(angle) @ (sizes * rates) + 0.1 * velocity + coulomb * np.sign(velocity)
    torque += gravity * np.cos(0.2 * position) + 0.01 * rng.standard_normal(samples)
    channels = {"time": time, "torque": torque, "velocity": velocity, "position": position}
    return Recording("arm", Motion.ROTARY, channels, np.zeros(samples, dtype=np.int64))


def said(recording: Recording, torque: np.ndarray) -> Severity | None:
    spoilt = replace(recording, channels={**recording.channels, "torque": torque})
    return next((one.severity for one in findings(spoilt) if one.kind == "torque-magnitude"), None)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("seed", range(3))
def test_the_size_of_a_torque_stops(seed: int, sign: float) -> None:
    good = drive(seed=seed)
    assert said(good, good.torque) is None
    assert said(good, sign * np.abs(good.torque)) is Severity.STOP


@pytest.mark.parametrize("seed", range(3))
def test_beside_gravity_it_is_said_as_well(seed: int) -> None:
    good = drive(gravity=0.5, seed=seed)
    assert said(good, good.torque) is None
    assert said(good, np.abs(good.torque)) in (Severity.STOP, Severity.WARN)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_torque_that_gravity_keeps_on_one_side_is_none(seed: int, sign: float) -> None:
    held = drive(gravity=6.0, seed=seed)
    assert np.all(held.torque > 0.0)
    assert said(held, sign * held.torque) is None


def test_noise_about_nothing_does_not_hide_it() -> None:
    good = drive()
    noise = 0.003 * np.random.default_rng(1).standard_normal(len(good))
    assert said(good, np.abs(good.torque) + noise) is Severity.STOP


def moves(seed: int, samples: int = 15000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, velocity and acceleration of strokes up and down, each a sin² in speed, with dwells between."""
    rng, time = np.random.default_rng(seed), 2e-3 * np.arange(samples)
    velocity, rate, begin, way = np.zeros(samples), np.zeros(samples), 0.3, 1.0
    while begin < time[-1]:
        takes, top = rng.uniform(0.8, 2.0), way * rng.uniform(0.3, 0.6)
        phase = np.pi * (time - begin) / takes
        inside = (phase >= 0.0) & (phase <= np.pi)
        velocity += top * np.where(inside, np.sin(phase) ** 2, 0.0)
        rate += top * np.pi / takes * np.where(inside, np.sin(2.0 * phase), 0.0)
        begin, way = begin + takes + rng.uniform(0.8, 2.0), -way
    return time, velocity, rate


def axis(torque: np.ndarray, time: np.ndarray, velocity: np.ndarray, seed: int) -> Recording:
    rng, zeros = np.random.default_rng(seed), np.zeros(len(time), dtype=np.int64)
    position = np.cumsum(velocity) * 2e-3 + 2e-5 * rng.standard_normal(len(time))
    channels = {"time": time, "velocity": velocity + 1e-3 * rng.standard_normal(len(time)), "position": position}
    return Recording("axis", Motion.LINEAR, {**channels, "torque": torque}, zeros)


@pytest.mark.parametrize("mass", [320.0, 900.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_hoist_whose_brake_closes_in_its_dwells_has_its_sign(seed: int, mass: float) -> None:
    """Its weight is on the motor in motion only, up and down, which is not a friction of that size."""
    time, velocity, rate = moves(seed)
    moving = velocity != 0.0
    force = np.where(moving, mass * (9.81 + rate) + 400.0 * velocity + 150.0 * np.sign(velocity), 0.0)
    force += 10.0 * np.random.default_rng(seed).standard_normal(len(time))
    recording = axis(force, time, velocity, seed)
    assert said(recording, recording.torque) is None


@pytest.mark.parametrize("seed", range(3))
def test_the_size_of_a_force_in_strokes_with_dwells_stops(seed: int) -> None:
    time, velocity, rate = moves(seed)
    force = 320.0 * rate + 400.0 * velocity + 150.0 * np.sign(velocity)
    force += 10.0 * np.random.default_rng(seed).standard_normal(len(time))
    recording = axis(force, time, velocity, seed)
    assert said(recording, recording.torque) is None
    assert said(recording, np.abs(force)) is Severity.STOP


@pytest.mark.parametrize("seed", range(3))
def test_a_few_parts_of_the_record_with_most_of_the_torque_do_not_hide_it(seed: int) -> None:
    """In each part signs explain all: that the torque is large in some of them is no chance."""
    rng, time = np.random.default_rng(seed), 2e-3 * np.arange(16000)
    size = np.exp(-((time[:, None] - rng.uniform(2.0, 30.0, 3)) ** 2) / 0.8).sum(axis=1) * 8.0 + 0.4
    velocity = size * np.sin(6.0 * time)
    rate = np.gradient(velocity, time)
    torque = 0.05 * rate + 0.1 * velocity + 0.1 * np.sign(velocity) + 0.005 * rng.standard_normal(len(time))
    recording = replace(axis(torque, time, velocity, seed), motion=Motion.ROTARY)
    assert said(recording, torque) is None
    assert said(recording, np.abs(torque)) is Severity.STOP
