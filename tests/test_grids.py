"""The grid on which a signal stands, and torques that are switched."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals import noise_of, quantum
from fricmodels.signals.switched import is_switched, torque_noise


def logged(time: np.ndarray, torque: np.ndarray) -> Recording:
    """Return a recording with a torque, of a drive whose motion does not matter."""
    return Recording("log", Motion.ROTARY, {"time": time, "torque": torque}, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("seed", range(5))
def test_a_coarse_grid_that_was_rounded_again(seed: int) -> None:
    """By few digits, or to the finer grid of a bus; values with as many digits as they need stand on that of these."""
    values = np.random.default_rng(seed).normal(0, 1.0, 2_000)
    assert quantum(np.round(np.round(values / 0.013192) * 0.013192, 5)) == pytest.approx(0.013192, rel=1e-3)
    bus = 0.02198
    assert quantum(bus * np.round(np.round(values / 0.0649) * 0.0649 / bus)) == pytest.approx(bus)
    assert quantum(np.round(values, 4)) == pytest.approx(1e-4)
    assert quantum(values) == 0.0


def test_a_torque_that_is_switched_is_exact_and_one_in_coarse_steps_is_rounded() -> None:
    time = np.arange(4_000) / 500.0
    relay = 13.3 * np.sign(np.sin(3.0 * time))
    assert is_switched(relay)
    assert torque_noise(logged(time, relay)).deviation == 0.0
    rounded = 4.0 * np.round(13.3 * np.sin(3.0 * time) / 4.0)
    assert not is_switched(rounded)
    assert torque_noise(logged(time, rounded)).deviation == pytest.approx(4.0 / np.sqrt(12.0), rel=0.2)


def test_a_command_in_a_few_steps_is_exact_however_fine_the_grid_that_they_stand_on() -> None:
    time = np.arange(20_000) / 200.0
    levels = np.array([2.2, -1.6, 1.4, 0.0, -1.2, 2.5, -2.2, 1.8, 1.2])
    command = levels[np.arange(20_000) // 600 % len(levels)]
    assert is_switched(command)
    assert torque_noise(logged(time, command)).deviation == 0.0


def test_what_was_measured_is_no_command_though_it_stays_on_few_values() -> None:
    rng = np.random.default_rng(0)
    levels = np.array([2.2, -1.6, 1.4, 0.0, -1.2, 2.5, -2.2, 1.8, 1.2])
    command = levels[np.arange(20_000) // 600 % len(levels)]
    assert not is_switched(np.round(command + 0.02 * rng.standard_normal(20_000), 2)), "noise shows levels beside them"
    assert not is_switched(0.1 * np.round(25.0 * np.sin(np.arange(20_000) / 900.0)))
    assert not is_switched(np.repeat(np.round(rng.standard_normal(200), 3), 5)), "polled"
    assert not is_switched(np.clip(np.round(9.0 * np.sin(np.arange(20_000) / 90.0), 3), -3.0, 3.0)), "clipped"
    assert not is_switched(np.round(np.arange(20_000) / 5_000.0))


@pytest.mark.parametrize("change", [0.0, 1e-12, 1e-9])
def test_a_step_is_known_from_all_the_way(change: float) -> None:
    rng = np.random.default_rng(4)
    step = 2 * np.pi / 4096
    values = step * np.round(rng.uniform(-3e5, 3e5, 6000))  # neighbours are a hundred steps apart
    values *= 1 + change * rng.uniform(-1, 1, len(values))
    assert quantum(values) == pytest.approx(step, rel=1e-8)  # less than a hundredth of a step at the far end


@pytest.mark.parametrize("apart", [1, 100, 700])
def test_a_fine_grid_whose_values_were_rounded(apart: int) -> None:
    """An encoder of 16 bit over up to fourteen turns as single precision holds it, or with its ninth digit changed."""
    rng = np.random.default_rng(apart)
    step = 2 * np.pi / 2**16
    values = step * rng.integers(-650 * apart, 650 * apart, 1000)
    assert quantum(values.astype(np.float32).astype(float)) == pytest.approx(step, rel=1e-6)
    assert quantum(values * (1 + 1e-9 * rng.uniform(-1, 1, len(values)))) == pytest.approx(step, rel=1e-7)


@pytest.mark.parametrize("seed", range(20))
def test_values_that_stand_anywhere_have_no_grid(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(20, 3000))
    assert quantum(rng.standard_normal(count)) == 0.0
    assert quantum(np.sin(np.linspace(0.0, rng.uniform(1, 60), count))) == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_the_noise_of_rounding_does_not_hang_on_last_digits(seed: int) -> None:
    """Means of few rounded values lie on the edges of steps; there a last digit must decide nothing."""
    time = 0.01 * np.arange(2000)
    rng = np.random.default_rng(seed)
    course = 10.0 ** (1 + seed / 2) * (np.sin(3.0 * time + seed) + 0.4 * np.sin(6.9 * time))
    values = 2 * np.pi / 4096 * np.round(course / (2 * np.pi / 4096))
    weights = np.array([-0.5, 0.0, 0.5])
    exact = noise_of(time, values).after(weights)
    for change in (1e-12, 1e-9):
        other = values * (1 + change * rng.uniform(-1, 1, len(values)))
        assert noise_of(time, other).after(weights) == pytest.approx(exact, rel=1e-5)
