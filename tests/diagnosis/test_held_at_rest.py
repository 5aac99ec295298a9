"""A friction that acts at rest only: what a drive held in vain tells of it, and which effects would hold as much."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, compare, diagnose
from fricmodels.diagnosis.remaining import held_at_rest
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

INERTIA, COULOMB, STICK = 0.5, 2.0, 6.0


def dwelling(stick: float, seed: int = 0) -> Recording:
    """Return a drive that rests between moves; before each the torque rises to ``stick``, and it breaks away at once."""
    rng, time = np.random.default_rng(seed), np.arange(12_000) / 500.0
    phase = time % 2.0
    side = np.where((time // 2.0) % 2 == 0, 1.0, -1.0)
    moves = phase >= 1.0
    shape = np.where(moves, np.pi * (phase - 1.0), 0.0)
    velocity = side * 3.0 * np.sin(shape) ** 2
    slope = side * 3.0 * 2.0 * np.pi * np.sin(shape) * np.cos(shape)
    held = side * stick * np.clip(phase, 0.0, 1.0)
    torque = np.where(moves, INERTIA * slope + 0.4 * velocity + COULOMB * side, held)
    channels = {
        "time": time,
        "velocity": np.where(moves, velocity + 1e-3 * rng.standard_normal(len(time)), 0.0),
        "torque": torque + 0.01 * rng.standard_normal(len(time)),
    }
    return Recording("dwelling", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.fixture(scope="module")
def stuck() -> Diagnosis:
    return diagnose(dwelling(STICK), "coulomb-viscous", INERTIA)


def test_what_is_held_beyond_the_model_is_said_with_its_size(stuck: Diagnosis) -> None:
    rest = stuck.remaining
    if rest is None:  # it was named
        assert "stribeck" in stuck.findings[0].names
        return
    assert "at rest, where the drive holds up to 4 N m more than the 2 N m of the model" in rest.where
    assert rest.nearest[0].held_out_percent < 0.3 * stuck.comparison.errors.held_out_percent


@pytest.mark.parametrize(("stick", "said"), [(STICK, True), (0.9 * COULOMB, False)])
def test_nothing_is_said_where_the_model_holds_as_much(stick: float, said: bool) -> None:
    words = held_at_rest(compare(dwelling(stick), "coulomb-viscous", INERTIA))
    assert ("more than" in words) is said
