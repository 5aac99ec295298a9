"""Which of two sensors the motion is taken from: a position may be the worse one."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.prepared import surest_velocity

INTERVAL = 0.008


def trolley(position_noise: float, velocity_noise: float, seed: int = 0, offset: float = 0.0) -> Recording:
    """Return a trolley of 300 kg with friction 60 N + 12 N s/m on three sines, logged at 125 Hz."""
    rng, time = np.random.default_rng(seed), INTERVAL * np.arange(8000)
    rates, sizes, phases = np.array([0.4, 1.1, 2.3]), np.array([1.2, 0.7, 0.3]), rng.uniform(0, 6, 3)
    angle = np.outer(time, rates) + phases
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / rates)
    force = 300.0 * (np.cos(angle) @ (sizes * rates)) + 12.0 * velocity + 60.0 * np.sign(velocity) + offset
    channels = {
        "time": time,
        "torque": force + 2.0 * rng.standard_normal(len(time)),
        "velocity": velocity + velocity_noise * rng.standard_normal(len(time)),
        "position": position + position_noise * rng.standard_normal(len(time)),
    }
    return Recording("trolley", Motion.LINEAR, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize(
    ("position_noise", "velocity_noise", "by_position"),
    [
        (1e-3, 4e-3, False),  # smoothed over 31 samples, as the position was, this velocity has the lesser noise
        (1e-5, 4e-3, True),
        (1e-4, 0.1, True),
        (1e-4, 4e-4, False),
        (0.0, 4e-4, True),
        (1e-3, 0.0, False),
    ],
)
@pytest.mark.parametrize("seed", range(2))
def test_the_motion_is_taken_from_the_quieter_sensor(
    position_noise: float, velocity_noise: float, by_position: bool, seed: int
) -> None:
    found = surest_velocity(trolley(position_noise, velocity_noise, seed))
    assert ("velocity" in found.derived) == by_position


@pytest.mark.parametrize("seed", range(2))
def test_a_column_of_noisy_positions_makes_no_answer_worse(seed: int) -> None:
    """The printed error was ten times as large with the column as without it, and hid an offset of 4 N."""
    log = trolley(1e-3, 4e-3, seed, offset=4.0)
    alone = Recording("trolley", Motion.LINEAR, {n: log[n] for n in ("time", "torque", "velocity")}, log.run)
    errors = [compare(one, "coulomb-viscous", 300.0).errors.percent for one in (log, alone)]
    assert errors[0] == pytest.approx(errors[1], rel=0.02)
    with_offset = compare(log, "coulomb-viscous+torque-offset", 300.0)
    assert with_offset.estimate.parameters["torque-offset.tau_0"] == pytest.approx(4.0, abs=0.4)
    assert with_offset.errors.percent < 0.9 * errors[0]
