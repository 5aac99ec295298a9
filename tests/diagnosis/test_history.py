"""Time and distance since the drive turned or started, against a motion of which they are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.diagnosis.history import MotionHistory
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate

RATE, PERIOD, REST = 1000.0, 2.0, 0.5
AMPLITUDE = 3.0


def moved(noise: float, *, resting: bool) -> Recording:
    """Half sines to and fro, each followed by a rest if wanted; the torque is that of a Coulomb-viscous drive."""
    rng = np.random.default_rng(0)
    time = np.arange(12_000) / RATE
    length = PERIOD / 2 + (REST if resting else 0.0)
    stroke, within = np.divmod(time, length)
    moving = within < PERIOD / 2
    side = np.where(stroke % 2 == 0, 1.0, -1.0)
    angle = 2 * np.pi * within / PERIOD
    velocity = np.where(moving, side * AMPLITUDE * np.sin(angle), 0.0)
    acceleration = np.where(moving, side * AMPLITUDE * 2 * np.pi / PERIOD * np.cos(angle), 0.0)
    torque = 2 * acceleration + 0.5 * velocity + 3 * np.sign(velocity)
    position = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) / RATE)])
    measured = velocity + noise * rng.standard_normal(len(time))
    channels = {"time": time, "torque": torque, "velocity": measured, "position": position}
    return Recording("made", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def history(recording: Recording) -> tuple[MotionHistory, NDArray[np.float64]]:
    problem, _ = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    return MotionHistory.of(problem), problem.recording.time


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_turning_without_rest(noise: float) -> None:
    past, time = history(moved(noise, resting=False))
    count = len(time)
    stroke, within = np.divmod(time, PERIOD / 2)
    inner = (within > 0.1) & (within < PERIOD / 2 - 0.1)
    np.testing.assert_array_equal(past.side[:count][inner], np.where(stroke % 2 == 0, 1.0, -1.0)[inner])
    np.testing.assert_allclose(past.turned[:count][inner], within[inner], atol=0.02)
    distance = AMPLITUDE * PERIOD / (2 * np.pi) * (1 - np.cos(2 * np.pi * within / PERIOD))
    np.testing.assert_allclose(past.travelled[:count][inner], distance[inner], atol=0.02)
    np.testing.assert_array_equal(past.dwell[:count][inner], 0.0)


def test_rests_are_counted() -> None:
    past, time = history(moved(0.002, resting=True))
    count = len(time)
    stroke, within = np.divmod(time, PERIOD / 2 + REST)
    inner = (stroke > 0) & (within > 0.1) & (within < PERIOD / 2 - 0.1)
    np.testing.assert_allclose(past.dwell[:count][inner], REST, atol=0.05)
    np.testing.assert_allclose(past.started[:count][inner], within[inner], atol=0.02)
    distance = AMPLITUDE * PERIOD / (2 * np.pi) * (1 - np.cos(2 * np.pi * within / PERIOD))
    np.testing.assert_allclose(past.moved[:count][inner], distance[inner], atol=0.02)
