"""What is said of a channel that predicts what remains: whether with the sign of the motion, and from when to when."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

SAMPLES, INTERVAL = 12_000, 5e-3
TIME = INTERVAL * np.arange(SAMPLES)
INERTIA = 0.05
Torque = Callable[[np.ndarray], np.ndarray]


FAST = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0]), np.array([1.6, 1.8, 4.9])
SLOW = 2.0 * np.pi / 30.0 * np.array([1.0, 3.3]), np.array([3.0, 0.5]), np.array([0.0, 1.0])
"""Frequencies [rad/s], amplitudes and phases of the velocity."""


def recording(beyond: Torque, start: float = 0.0, motion: tuple[np.ndarray, ...] = FAST) -> Recording:
    """Return a drive with Coulomb and viscous friction and a torque beyond these, a function of the velocity."""
    frequencies, sizes, phases = motion
    rng = np.random.default_rng(2)
    angle = np.outer(TIME, frequencies) + phases
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / frequencies)
    torque = INERTIA * np.cos(angle) @ (sizes * frequencies) + 0.1 * velocity + 0.5 * np.sign(velocity)
    channels = {
        "time": start + TIME,
        "torque": torque + beyond(velocity) + 0.01 * rng.standard_normal(SAMPLES),
        "velocity": velocity + 1e-3 * rng.standard_normal(SAMPLES),
        "position": position + 1e-5 * rng.standard_normal(SAMPLES),
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


def brake(velocity: np.ndarray) -> np.ndarray:
    return np.where((TIME > 20.0) & (TIME < 33.0), 0.3, 0.0) * np.sign(velocity)


def gusts(velocity: np.ndarray) -> np.ndarray:
    """Return a torque that wanders over seconds, whatever the drive does."""
    knots = np.arange(0.0, TIME[-1] + 4.0, 4.0)
    return np.interp(TIME, knots, 0.4 * np.random.default_rng(1).standard_normal(len(knots)))


def breathing(velocity: np.ndarray) -> np.ndarray:
    return 0.2 * np.sin(2 * np.pi * TIME / 37.0) * np.sign(velocity)


def found(beyond: Torque, start: float = 0.0, motion: tuple[np.ndarray, ...] = FAST, every: int = 1) -> Diagnosis:
    seen = recording(beyond, start, motion).select(slice(None, None, every))
    diagnosis = diagnose(seen, "coulomb-viscous", INERTIA)
    assert diagnosis.verdict == "unknown-effect"
    return diagnosis


@pytest.mark.parametrize("start", [pytest.param(0.0, marks=pytest.mark.long), 100.0])
def test_a_friction_between_two_instants_is_said_with_these(start: float) -> None:
    rest = found(brake, start, every=2).remaining
    assert rest is not None
    assert rest.channel.startswith("time")
    assert "along the motion" in rest.channel
    words = rest.where.split()
    assert words[:2] == ["from", "about"]
    assert float(words[2]) == pytest.approx(20.0, abs=1.5)
    assert float(words[5]) == pytest.approx(33.0, abs=1.5)
    assert "counted from the beginning" in rest.where
    assert float(words[-3]) == pytest.approx(0.3, abs=0.05)


@pytest.mark.long
def test_a_torque_in_time_that_does_not_turn_with_the_motion_is_not_said_to() -> None:
    """A slow motion turns slow waves into finer ones, which follow the torque better for that alone."""
    diagnosis = found(gusts, motion=SLOW)
    assert diagnosis.view is not None
    assert diagnosis.view.channels.startswith("time")
    assert "along the motion" not in diagnosis.view.channels
    rest = diagnosis.remaining
    assert rest is not None
    assert "from about" not in rest.where


@pytest.mark.long
def test_a_friction_that_goes_with_time_is_said_to_turn_with_the_motion() -> None:
    diagnosis = found(breathing)
    assert diagnosis.view is not None
    assert diagnosis.view.channels.startswith("time")
    assert "along the motion" in diagnosis.view.channels
    rest = diagnosis.remaining
    assert rest is not None
    assert "from about" not in rest.where


def test_where_the_clock_starts_anew_no_instant_is_said() -> None:
    """The brake acts from 10 to 18 s of each of two runs: an instant would be one of two."""

    def brake_in_both(velocity: np.ndarray) -> np.ndarray:
        since = TIME % (TIME[-1] / 2.0)
        return np.where((since > 10.0) & (since < 18.0), 0.3, 0.0) * np.sign(velocity)

    whole = recording(brake_in_both)
    half = np.arange(SAMPLES) // (SAMPLES // 2)
    twice = replace(whole, channels={**whole.channels, "time": TIME - half * TIME[SAMPLES // 2]}, run=half)
    rest = diagnose(twice, "coulomb-viscous", INERTIA).remaining
    assert rest is not None
    assert "from about" not in rest.where
