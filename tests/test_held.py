"""Without a position the torque says that a drive did not move between two rests."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals import resting
from fricmodels.signals.in_place import held

STEP = 0.002


def recorded(velocity: np.ndarray, torque: np.ndarray) -> Recording:
    channels = {"time": STEP * np.arange(len(velocity)), "torque": torque, "velocity": velocity}
    return Recording("made", Motion.ROTARY, channels, np.zeros(len(velocity), dtype=np.int64))


@pytest.mark.parametrize(
    ("torque", "speed", "joined"),
    [
        (0.30, 0.02, True),
        (-0.10, 0.02, True),  # less than before, and than after
        (0.60, 0.02, False),  # more than it held: it may have slid
        (-0.60, 0.02, False),
        (0.30, 0.20, False),  # fast: something else moved it
    ],
)
def test_rests_are_one_if_no_more_torque_acts_between_them(torque: float, speed: float, joined: bool) -> None:
    """Between 100 and 140 the velocity shows a little; 0.2 to 0.4 N m acted before, −0.2 to 0.4 N m after."""
    velocity = np.where((np.arange(200) >= 100) & (np.arange(200) < 140), speed, 0.0)
    acting = np.r_[np.linspace(0.2, 0.4, 100), np.full(40, torque), np.linspace(0.4, -0.2, 60)]
    mask = velocity == 0.0
    found = held(recorded(velocity, acting), mask, velocity, 0.05)
    assert found[100:140].all() == joined
    assert (found[mask]).all()


def test_lasting_noise_does_not_break_a_rest_in_which_the_torque_stands() -> None:
    """Strokes with friction of 0.5 N m, and rests in which the controller leaves a torque of 0.2 N m."""
    time = STEP * np.arange(12_000)
    inside = (time % 3.0) > 1.5
    true = np.where(inside, 0.0, 2.0 * np.sin(np.pi * (time % 3.0) / 1.5))
    rng = np.random.default_rng(1)
    noise = np.zeros(len(time))
    for k in range(1, len(time)):
        noise[k] = 0.97 * noise[k - 1] + 0.001 * rng.standard_normal()
    torque = np.where(inside, 0.2, 0.5 + 0.3 * np.gradient(true, STEP)) + 0.005 * rng.standard_normal(len(time))
    recording = recorded(true + noise, torque)
    rest = resting(recording)
    core = inside & ((time % 3.0) > 1.6) & ((time % 3.0) < 2.9)
    assert np.mean(rest[core]) > 0.995
    assert not rest[np.abs(true) > 0.2].any()
