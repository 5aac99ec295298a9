"""A large error that neither noise nor sampling makes is not adequate, though no row of the motion sees it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

MASS, K_V, K_C, STEP = 40.0, 120.0, 60.0, 2e-3


def axis(play: float, seed: int = 0) -> Recording:
    """Return an axis that goes to and fro at constant speed, with rounded turns, whose scale has play [m]."""
    time = STEP * np.arange(10_000)
    turns = np.sin(2 * np.pi * time / 4.2)
    velocity = 0.12 * np.tanh(turns / 0.15)
    position = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * STEP)])
    seen, at = np.empty_like(position), position[0]
    for i, here in enumerate(position):
        at = min(max(at, here - 0.5 * play), here + 0.5 * play)
        seen[i] = at
    rng = np.random.default_rng(seed)
    force = MASS * np.gradient(velocity, time) + K_V * velocity + K_C * np.sign(velocity)
    channels = {
        "time": time,
        "torque": force + 0.3 * rng.standard_normal(len(time)),
        "position": seen + 2e-8 * rng.standard_normal(len(time)),
    }
    return Recording("axis", Motion.LINEAR, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.long
def test_a_scale_with_play_is_not_adequate() -> None:
    diagnosis = diagnose(axis(5e-4), "coulomb-viscous", MASS)
    assert diagnosis.verdict == "unknown-effect"
    assert diagnosis.comparison.errors.held_out_percent > 10.0
    without = diagnose(axis(5e-4), "coulomb-viscous", MASS, policy=replace(POLICY, large_error=np.inf))
    assert without.verdict == "adequate", "the rows do not see it"


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2, 3))])
def test_the_same_axis_without_play_is_adequate(seed: int) -> None:
    assert diagnose(axis(0.0, seed), "coulomb-viscous", MASS).verdict == "adequate"
