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
