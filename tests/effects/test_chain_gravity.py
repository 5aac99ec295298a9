"""The distal joint of an arm in the vertical plane: gravity by the sum of both angles, found and not confused."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels import diagnose
from fricmodels.dimension import Motion
from fricmodels.effects.chain_gravity import ChainGravity
from fricmodels.recording import Recording

INERTIA, SIZE = 0.2, 1.7


def arm(sense: float, *, still: bool = False) -> Recording:
    """Return the log of the second joint, whose link hangs at q + x, or q − x where joints count in opposite senses.

    Args:
        sense: of the first joint's angle x. still: whether the first joint stands.
    """
    rng = np.random.default_rng(5)
    time = 0.005 * np.arange(8000)
    q, velocity, acceleration = (1.2 * wave(time, 0.37, 0.0, k) + 0.5 * wave(time, 0.83, 1.0, k) for k in range(3))
    x = np.full_like(time, 0.4) if still else 1.5 * wave(time, 0.23, 2.0, 0)
    friction = 1.1 * np.sign(velocity) + 0.5 * velocity
    torque = INERTIA * acceleration + friction + SIZE * np.cos(q + sense * x)
    channels = {
        "time": time,
        "torque": torque + 0.02 * rng.standard_normal(len(time)),
        "velocity": velocity + 0.002 * rng.standard_normal(len(time)),
        "position": q,
        "other.j1_position": x,
    }
    return Recording(
        "arm", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64), units={"other.j1_position": "rad"}
    )


def wave(time: np.ndarray, frequency: float, phase: float, order: int) -> np.ndarray:
    """Return a sine or its derivative."""
    rate = 2.0 * np.pi * frequency
    return rate**order * np.sin(rate * time + phase + 0.5 * np.pi * order)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_gravity_of_a_link_behind_two_joints_is_named_and_sized(sense: float) -> None:
    found = diagnose(arm(sense), "coulomb-viscous", INERTIA)
    assert found.findings[0].names[0] == "chain-gravity(j1_position)"
    with_it = diagnose(arm(sense), "coulomb-viscous+chain-gravity(j1_position)", INERTIA)
    assert with_it.verdict == "adequate"
    p = with_it.comparison.estimate.parameters
    expected = {"a": SIZE, "b": 0.0, "c": 0.0, "d": -sense * SIZE}
    for symbol, value in expected.items():
        assert p[f"chain-gravity(j1_position).{symbol}"] == pytest.approx(value, abs=0.02)


def test_beside_a_joint_that_stands_it_is_the_gravity_of_this_one() -> None:
    found = diagnose(arm(1.0, still=True), "coulomb-viscous", INERTIA)
    assert "gravity" in found.findings[0].names


def test_it_needs_the_angle_of_this_joint() -> None:
    recording = arm(1.0)
    channels = {name: values for name, values in recording.channels.items() if name != "position"}
    without = Recording("arm", Motion.ROTARY, channels, recording.run, units=recording.units)
    assert ChainGravity.candidates(without) == []
    assert [one.name for one in ChainGravity.candidates(recording)] == ["chain-gravity(j1_position)"]
