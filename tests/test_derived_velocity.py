"""The weak form takes positions as they are: their changes are mean velocities, and it knows over what."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.test_functions import TestFunctions as Functions
from fricmodels.weakform.test_functions import mean_velocity


@pytest.mark.parametrize("jitter", [0.0, 0.3])
@pytest.mark.parametrize("width", [16, 24, 64])
def test_torque_that_jumps_is_balanced_by_positions(width: int, jitter: float) -> None:
    rng = np.random.default_rng(width)
    count = 4000
    step = 0.01 * (1 + jitter * rng.uniform(-1, 1, count))
    torque = np.repeat(
        rng.standard_normal(count // 20), 20
    )  # held from each sample to the next; no friction, inertia 1
    velocity = np.concatenate([[0.0], np.cumsum(torque[:-1] * step[:-1])])
    position = np.concatenate([[0.0], np.cumsum((velocity[:-1] + 0.5 * step[:-1] * torque[:-1]) * step[:-1])])
    time = np.concatenate([[0.0], np.cumsum(step[:-1])])
    channels = {"time": time, "torque": torque, "velocity": velocity, "position": position}
    recording = Recording("made", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))
    test_functions = Functions(recording, width, np.zeros(count, dtype=bool), over_cells=True)
    # Between two mean velocities lie half of a cell before a sample and half of the one after.
    impulse = 0.5 * (torque * step + np.append(0.0, (torque * step)[:-1]))
    changes = np.append(0.0, np.diff(mean_velocity(recording, position)))[:-1]
    assert changes[1:] == pytest.approx(impulse[1 : count - 1], abs=1e-9)
    held = test_functions.integrals((torque * step)[None])[0] - 0.5 * test_functions.change(torque * step)
    assert test_functions.momentum(mean_velocity(recording, position)) == pytest.approx(held, abs=1e-9)


def test_over_a_run_that_ends_nothing_is_carried() -> None:
    """The last sample of a run has no mean velocity, and no test function needs it."""
    count = 200
    time = np.tile(np.arange(count) * 0.01, 2)
    position = np.concatenate([np.sin(time[:count]), 5.0 + np.cos(time[:count])])
    run = np.repeat([0, 1], count)
    channels = {"time": time, "torque": np.zeros(2 * count), "position": position}
    recording = Recording("two", Motion.ROTARY, channels, run)
    test_functions = Functions(recording, 16, np.zeros(2 * count, dtype=bool), over_cells=True)
    both = test_functions.momentum(mean_velocity(recording, position))
    single = []
    for number in (0, 1):
        one = recording.select(run == number)
        alone = Functions(one, 16, np.zeros(count, dtype=bool), over_cells=True)
        single.append(alone.momentum(mean_velocity(one, one["position"])))
    assert both == pytest.approx(np.concatenate(single), abs=1e-12)
