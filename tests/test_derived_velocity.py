"""A velocity derived from positions is a mean over a few samples; the weak form knows it."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative
from fricmodels.signals.weak_form import Bumps


@pytest.mark.parametrize(("half_width", "width"), [(0, 16), (1, 16), (2, 16), (5, 32), (9, 64)])
def test_torque_that_jumps_is_balanced_by_a_derived_velocity(half_width: int, width: int) -> None:
    rng = np.random.default_rng(half_width)
    interval, count = 0.01, 4000
    torque = np.repeat(rng.standard_normal(count // 20), 20)  # held over each sample; no friction, inertia 1
    velocity = np.concatenate([[0.0], np.cumsum(torque[:-1]) * interval])
    position = np.concatenate([[0.0], np.cumsum(velocity[:-1] + 0.5 * interval * torque[:-1]) * interval])
    time = np.arange(count) * interval
    if half_width:
        _, velocity = lanczos_derivative(time, position, half_width)
    channels = {"time": time, "torque": torque, "velocity": velocity}
    recording = Recording("made", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))
    bumps = Bumps(recording, width, np.zeros(count, dtype=bool), half_width=half_width)
    inner = slice(20, bumps.count - 20)  # the ends of a stretch are derived otherwise
    held = bumps.integrals(torque[None])[0] * interval - 0.5 * interval * bumps.change(torque)
    left = (bumps.momentum(velocity) - held)[inner]
    assert np.max(np.abs(left)) < 1e-9 * np.max(np.abs(held))
