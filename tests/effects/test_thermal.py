"""Friction that goes with the temperature leaves the law its own viscous coefficient, where that does not change."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

INERTIA, VISCOUS, COULOMB, RATE = 0.1, 0.25, 0.84, 0.03


@pytest.mark.parametrize("seed", [0, 1, 4])
def test_a_preload_that_changes_with_the_temperature_is_no_viscous_friction(seed: int) -> None:
    """A lubricant that thinned in 1 K would leave a ϑ_v ω alone, in the place of K_v ω."""
    rng = np.random.default_rng(seed)
    time: Array = 0.01 * np.arange(8000.0)
    lines = [(f, 2.0, rng.uniform(0, 2 * np.pi)) for f in (0.21, 0.53, 0.87, 1.3)]
    velocity = sum((a * np.sin(2 * np.pi * f * time + p) for f, a, p in lines), np.zeros_like(time))
    slope = sum((2 * np.pi * f * a * np.cos(2 * np.pi * f * time + p) for f, a, p in lines), np.zeros_like(time))
    temperature = 22.0 - 16.0 * np.sin(np.pi * time / 80.0) ** 2
    friction = VISCOUS * velocity + (COULOMB + RATE * temperature) * np.sign(velocity)
    channels = {
        "time": time,
        "velocity": velocity + 5e-3 * rng.standard_normal(len(time)),
        "torque": INERTIA * slope + friction + 0.05 * rng.standard_normal(len(time)),
        "temperature": temperature + 0.05 * rng.standard_normal(len(time)),
    }
    recording = Recording("preload", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    found = compare(recording, "coulomb-viscous+thermal", INERTIA).estimate.parameters
    assert found["K_v"] == pytest.approx(VISCOUS, rel=0.05)
    assert found["K_c"] == pytest.approx(COULOMB, rel=0.05)
    assert found["thermal.b"] == pytest.approx(RATE, rel=0.05)
    assert found["thermal.theta_v"] >= 10.0
