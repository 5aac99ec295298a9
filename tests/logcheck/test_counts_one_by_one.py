"""Counts of a slow drive come one by one: their error falls with the frequency, and is no colour of the velocity."""

from __future__ import annotations

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.logcheck import findings
from fricmodels.recording import Recording


def test_white_noise_beside_coarse_counts_is_white() -> None:
    """Moves at a speed of forty counts a second, recorded at 500 Hz."""
    rng, step = np.random.default_rng(8), 0.002
    time = step * np.arange(20_000)
    speed = 0.012 * np.sign(np.sin(2.0 * np.pi * time / 7.0)) * (1.0 + 0.2 * np.sin(1.3 * time))
    velocity = np.convolve(speed, np.ones(50) / 50, "same")
    torque = (
        0.05 * np.gradient(velocity, step) + 0.8 * np.tanh(velocity / 1e-3) + 0.005 * rng.standard_normal(len(time))
    )
    count = 2.0 * np.pi / 20_000
    channels = {
        "time": time,
        "torque": torque,
        "velocity": velocity + 0.001 * rng.standard_normal(len(time)),
        "position": np.round(np.cumsum(velocity) * step / count) * count,
    }
    recording = Recording("slow", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    assert "coloured-noise" not in [one.kind for one in findings(recording) if one.channel == "velocity"]
