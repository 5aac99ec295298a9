"""Friction about standstill, where the direction of motion is not certain and the rows see hardly any of it."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose, improve
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

FINE = 40
INERTIA, VISCOUS, COULOMB, SPEED = 0.0056, 0.004, 2.2, 4.0


def sine(fall: float, seed: int) -> Recording:
    """Record a sine of 60 rad/s of a drive whose friction is higher by ``fall`` [N m] where it hardly moves."""
    rng, rate, omega = np.random.default_rng(seed), 120.0, 2 * np.pi * 0.8
    count = int(16 * rate)
    time = (np.arange(count * FINE) + 0.5) / (rate * FINE)
    velocity, position = 60.0 * np.sin(omega * time + 0.3), -60.0 / omega * np.cos(omega * time + 0.3)
    friction = VISCOUS * velocity + (COULOMB + fall * np.exp(-np.abs(velocity) / SPEED)) * np.sign(velocity)
    torque = INERTIA * 60.0 * omega * np.cos(omega * time + 0.3) + friction
    middle = slice(FINE // 2, None, FINE)
    channels = {
        "time": time[middle],
        "velocity": velocity[middle] + 0.6 * rng.standard_normal(count),
        "position": position[middle] + 1e-4 * rng.standard_normal(count),
        "torque": torque.reshape(-1, FINE).mean(axis=1) + 0.02 * rng.standard_normal(count),
    }
    return Recording("sine", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_friction_that_falls_at_low_speed_is_named_though_the_rows_do_not_see_it(seed: int) -> None:
    ladder = improve(sine(1.3, seed), "coulomb-viscous", INERTIA)
    assert [rung.added for rung in ladder.rungs] == ["", "stribeck"]
    first, last = (rung.comparison for rung in (ladder.rungs[0], ladder.rungs[-1]))
    assert last.errors.held_out_percent < 0.4 * first.errors.held_out_percent
    found = last.estimate.parameters
    rest = COULOMB + 1.3 * np.exp(-6.0 / SPEED)
    own = found["stribeck.F_s"] * np.exp(-((6.0 / found["stribeck.omega_s"]) ** found["stribeck.delta"]))
    assert found["K_c"] + own == pytest.approx(rest, rel=0.04), "the friction at 6 rad/s"
    assert ladder.last.verdict == "adequate"


def test_what_would_have_been_seen_is_no_less_than_what_was_not() -> None:
    """Of a Stribeck friction the rows see next to nothing: what they would have shown is far more of the whole."""
    seen = diagnose(sine(0.0, 1), "coulomb-viscous", INERTIA).visibility
    assert seen["torque-offset"].smallest_percent < 1.0
    hidden = seen["stribeck"]
    assert hidden.smallest_percent > 20.0 or "direction of motion is not certain" in hidden.missing


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_without_it_nothing_is_named(seed: int) -> None:
    ladder = improve(sine(0.0, seed), "coulomb-viscous", INERTIA)
    assert len(ladder.rungs) == 1
    assert ladder.last.verdict == "adequate"
