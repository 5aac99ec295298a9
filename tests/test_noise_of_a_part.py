"""The torque's noise in what is fitted and what is kept back: that of the whole recording they were cut from."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals.switched import torque_noise

NOISE = 0.05


def moves(seed: int) -> Recording:
    """Half a minute of a servo with 1440 counts a turn and a noisy current, logged at 100 Hz: twenty moves."""
    time, rng = np.arange(3000) / 100.0, np.random.default_rng(seed)
    within, number = time % 1.5, (time // 1.5).astype(int)
    velocity = np.where(number % 2 == 0, 1, -1) * (4 + 2 * (number % 3))
    velocity = velocity * np.clip(np.minimum(within, 1.3 - within) / 0.25, 0, 1)
    position = np.concatenate([[0.0], np.cumsum(0.005 * (velocity[1:] + velocity[:-1]))])
    torque = 0.02 * np.gradient(velocity, time) + np.sign(velocity) + 0.08 * velocity
    count = 2 * np.pi / 1440
    channels = {
        "time": time,
        "position": count * np.floor(position / count),
        "torque": np.round(torque + NOISE * rng.standard_normal(3000), 2),
    }
    return Recording("moves", Motion.ROTARY, channels, np.zeros(3000, dtype=np.int64))


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_leaves_in_a_tenth_of_a_second_what_a_mean_of_ten_samples_does(seed: int) -> None:
    """Told by four blocks of some strokes each it was a third of that, or twenty times as much."""
    found = compare(moves(seed), "coulomb-viscous", 0.02)
    whole = torque_noise(moves(seed))
    assert torque_noise(found.train) == torque_noise(found.test) == whole
    slowest = found.errors.bands[-1]
    mean = 100 * NOISE / np.sqrt(10.0) / found.train.rms_torque
    assert slowest.window_ms == pytest.approx(100.0)
    assert slowest.noise_floor_percent == pytest.approx(mean, rel=0.3)
    assert slowest.noise_floor_percent < slowest.held_out_percent


def test_a_part_with_another_torque_has_its_own_noise() -> None:
    """As where a torque was exchanged after the cut: the whole says nothing of it."""
    part = moves(0).remembering().select(np.arange(1500), "half")
    smooth = part.with_channels(derived=False, torque=np.sin(part.time))
    assert torque_noise(part) == torque_noise(moves(0))
    assert torque_noise(smooth).deviation < 0.01 * NOISE
