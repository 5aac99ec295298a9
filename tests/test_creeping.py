"""A drive whose friction rises from nothing creeps at rest: its sensors see it, and no Coulomb friction acts there."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.comparison import compare
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals.creeping import creeping_speed, creeping_stretches, held_while_creeping

INERTIA, TRUE, SOFT = 0.1, {"K_v": 0.1, "K_c": 0.4}, 0.004
"""SOFT: speed at which friction has risen to three quarters [rad/s]."""


@pytest.fixture(scope="module")
def creeping() -> Recording:
    """Return moves by a position controller, with rests between, and a sensor that sees a drive creep in them."""
    rng, step = np.random.default_rng(1), 4e-3
    time = step * np.arange(10_000)
    places = np.cumsum(rng.choice([-1.0, 1.0], 40) * rng.uniform(0.5, 2.0, 40))
    starts = np.arange(40) * 1.0

    def wanted(t: float) -> tuple[float, float]:
        number = min(int(t), 39)
        before, after = (places[number - 1] if number else 0.0), places[number]
        part = min((t - starts[number]) / 0.5, 1.0)
        return before + (after - before) * part**2 * (3 - 2 * part), (after - before) * 12 * part * (1 - part)

    def pushes(t: float, q: float, w: float) -> float:
        place, speed = wanted(t)
        return 20.0 * (place - q) + 1.5 * (speed - w)

    def moves(t: float, state: np.ndarray) -> list[float]:
        q, w = state
        friction = TRUE["K_c"] * np.tanh(w / SOFT) + TRUE["K_v"] * w
        return [w, (pushes(t, q, w) - friction) / INERTIA]

    found = solve_ivp(
        moves, (0.0, time[-1]), [0.0, 0.0], method="LSODA", t_eval=time, rtol=1e-8, atol=1e-9, max_step=2e-3
    )
    torque = np.array([pushes(t, q, w) for t, q, w in zip(time, *found.y, strict=True)])
    channels = {
        "time": time,
        "torque": torque + 0.01 * rng.standard_normal(len(time)),
        "velocity": found.y[1] + 1e-4 * rng.standard_normal(len(time)),
        "position": np.round(found.y[0] / 1e-6) * 1e-6,
    }
    return Recording("creeping", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("inertia", [INERTIA, None])
def test_where_a_drive_creeps_no_coulomb_friction_is_asked_for(creeping: Recording, inertia: float | None) -> None:
    """K_c was 11 % too small and K_v 21 % too large, of a clean drive."""
    found = compare(creeping, "coulomb-viscous", inertia)
    for key, true in TRUE.items():
        assert found.estimate.parameters[key] == pytest.approx(true, rel=0.02)
        assert abs(found.estimate.parameters[key] - true) < 3.5 * found.estimate.standard_errors[key]
    assert found.errors.held_out_percent < 6.0


def test_a_drive_that_creeps_lacks_no_effect(creeping: Recording) -> None:
    """Just above the speeds at which it creeps less friction acts, and that is all that is said."""
    found = diagnose(creeping, "coulomb-viscous", INERTIA)
    assert not found.findings
    assert found.comparison.errors.held_out_percent < 2.0


def test_a_slow_motion_that_slides_is_none(creeping: Recording) -> None:
    size = len(creeping)
    speed, rest = np.where(np.arange(size) < 2000, 0.005, 1.0), np.zeros(size, dtype=bool)
    limits = np.full(size, -TRUE["K_c"]), np.full(size, TRUE["K_c"])
    for share, held in ((1.0, False), (0.5, True)):
        log = creeping.with_channels(derived=False, torque=np.full(size, share * TRUE["K_c"]))
        creeps = creeping_stretches(log, speed, rest, creeping_speed(speed))
        found = held_while_creeping(log, speed, creeps, INERTIA, lambda: limits)
        assert np.all(found[:1999] == held)
        assert not found[2000:].any()
