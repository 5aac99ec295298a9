"""Over part of a turn gravity is nearly an offset: which of the two it is takes a wider range, and both are said."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.diagnosis import diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

STEP = 0.01


def door(swing: float, offset: float, gravity: float) -> Recording:
    """Return a leaf that swings about 45° by so many radians either way, with noise of a fifth of its torque."""
    rng = np.random.default_rng(2)
    time: Array = STEP * np.arange(6000.0)
    lines = ((0.11, 0.5, 0.0), (0.23, 0.3, 1.0), (0.37, 0.2, 2.0))
    phases = [(2 * np.pi * f, a * swing, 2 * np.pi * f * time + p) for f, a, p in lines]
    position = 0.8 + sum((a * np.sin(x) for _, a, x in phases), np.zeros_like(time))
    velocity = sum((a * w * np.cos(x) for w, a, x in phases), np.zeros_like(time))
    slope = sum((-a * w**2 * np.sin(x) for w, a, x in phases), np.zeros_like(time))
    torque = 9.0 * slope + 8.0 * np.sign(velocity) + 3.0 * velocity + offset + gravity * np.cos(position)
    channels = {
        "time": time,
        "position": position + 1e-5 * rng.standard_normal(len(time)),
        "velocity": velocity + 1e-3 * rng.standard_normal(len(time)),
        "torque": torque + 1.5 * rng.standard_normal(len(time)),
    }
    return Recording("door", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize(("offset", "gravity"), [(0.0, 3.0), pytest.param(2.0, 0.0, marks=pytest.mark.long)])
def test_over_a_narrow_range_both_are_said(offset: float, gravity: float) -> None:
    found = diagnose(door(0.12, offset, gravity), "coulomb-viscous", 9.0)
    assert {"torque-offset", "gravity"} <= set(found.findings[0].names)
    assert "range" in found.findings[0].separated_by


@pytest.mark.long
def test_over_a_wide_range_gravity_is_no_offset() -> None:
    found = diagnose(door(2.5, 0.0, 3.0), "coulomb-viscous", 9.0)
    assert found.findings[0].names[0] == "gravity"
    assert "torque-offset" not in found.findings[0].names
    other = diagnose(door(2.5, 2.0, 0.0), "coulomb-viscous", 9.0)
    assert other.findings[0].names[0] == "torque-offset"
    assert "gravity" not in other.findings[0].names
