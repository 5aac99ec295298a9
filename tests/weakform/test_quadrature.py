"""Torques are integrated as exactly as the changes of velocity that they cause."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.cells import along_cubics
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.test_functions import TestFunctions as Functions
from fricmodels.weakform.test_functions import mean_velocity

HARDLY = 1e-9


def swinging(rate: float, jitter: float = 0.0, friction: float = 0.0) -> Recording:
    """Return a drive of inertia 1 that is driven with 2 Hz, known in closed form; friction makes its torque jump."""
    rng = np.random.default_rng(1)
    count = int(8 * rate)
    time = (np.arange(count) + jitter * rng.uniform(-0.5, 0.5, count)) / rate
    turn = 2 * np.pi * 2.0
    velocity = 1.3 * np.cos(turn * time + 0.1)
    channels = {
        "time": time,
        "position": 1.3 / turn * np.sin(turn * time + 0.1),
        "velocity": velocity,
        "torque": -1.3 * turn * np.sin(turn * time + 0.1) + friction * np.sign(velocity),
    }
    return Recording("swinging", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))


def imbalance(recording: Recording, over_cells: bool) -> float:
    """Return the RMS of ∫φ τ dt − ∫φ dω, over the RMS of either."""
    never = np.zeros(len(recording), dtype=bool)
    test_functions = Functions(recording, 16, never, over_cells=over_cells)
    around = recording.with_channels(velocity=recording.velocity + 10.0)  # nothing turns: no cell is split
    quadrature = Quadrature.of(around, around.velocity, never)
    motion = mean_velocity(recording, recording["position"]) if over_cells else recording.velocity
    impulse, change = test_functions.torques(quadrature, recording.torque[None])[0], test_functions.momentum(motion)
    return float(np.sqrt(np.mean((impulse - change) ** 2) / np.mean(change**2)))


@pytest.mark.parametrize("over_cells", [False, True])
def test_a_smooth_torque_balances_to_fourth_order(over_cells: bool) -> None:
    """The trapezium rule leaves (ωh)²/12 of it, or twice as much where the velocity comes from positions."""
    coarse, fine = imbalance(swinging(100.0), over_cells), imbalance(swinging(200.0), over_cells)
    phase = 2 * np.pi * 2.0 / 100.0
    assert coarse < 0.05 * phase**2 / 12
    assert fine == pytest.approx(coarse / 16, rel=0.1)


@pytest.mark.parametrize("over_cells", [False, True])
def test_on_uneven_samples_it_balances_better_than_by_straight_lines(over_cells: bool) -> None:
    phase = 2 * np.pi * 2.0 / 100.0
    assert imbalance(swinging(100.0, jitter=0.6), over_cells) < 0.1 * phase**2 / 12


def test_a_torque_of_straight_lines_is_integrated_exactly_under_hats() -> None:
    """By hand: hats of unequal sides over a straight line."""
    recording = swinging(50.0, jitter=0.8)
    never = np.zeros(len(recording), dtype=bool)
    around = recording.with_channels(velocity=recording.velocity + 10.0)
    quadrature = Quadrature.of(around, around.velocity, never)
    time = recording.time
    values = quadrature.under_hats((3.0 + 2.0 * time)[None])[0]
    left, right = np.diff(time)[:-1], np.diff(time)[1:]
    middle = time[1:-1] + (right - left) / 3.0  # centre of a hat of unequal sides
    assert values[1:-1] == pytest.approx(0.5 * (left + right) * (3.0 + 2.0 * middle), rel=1e-12)


def test_hats_see_a_step_where_it_is() -> None:
    """A friction that jumps within a cell: its parts before and after the zero are weighted by where they lie."""
    recording = swinging(100.0)
    velocity = recording.velocity
    never = np.zeros(len(recording), dtype=bool)
    quadrature = Quadrature.of(recording, velocity, never)
    sign = np.sign(quadrature.recording.velocity)[None]
    hats, cells = quadrature.under_hats(sign)[0], quadrature.impulses(sign)[0]
    assert hats.sum() == pytest.approx(cells.sum(), rel=1e-12)
    k = int(quadrature.cell[3])
    step = float(np.diff(recording.time)[k])
    before, after = (2 * each[3] / step for each in (quadrature.before, quadrature.after))
    assert before == pytest.approx(velocity[k] / (velocity[k] - velocity[k + 1]), abs=0.01)
    side = np.sign(velocity[k])
    late = side * step * (0.5 * before**2 - 0.5 * (1 - (1 - after) ** 2))  # of sign(ω) times what rises from 0 to 1
    assert hats[k + 1] == pytest.approx(late - side * 0.5 * step, rel=1e-9)


def test_a_cubic_does_not_reach_over_a_reversal() -> None:
    recording = swinging(100.0, friction=5.0)
    never = np.zeros(len(recording), dtype=bool)
    quadrature = Quadrature.of(recording, recording.velocity, never)
    sign = np.sign(quadrature.recording.velocity)[None]
    found = np.empty((1, len(recording)))
    parts = quadrature.half, quadrature.cell, quadrature.before, quadrature.after, quadrature.bending
    along_cubics(sign, *parts, found)
    assert found == pytest.approx(quadrature.impulses(sign), abs=HARDLY)


@pytest.mark.parametrize("friction", [0.0, 3.0])
@pytest.mark.parametrize("over_cells", [False, True])
def test_it_balances_as_well_through_reversals(over_cells: bool, friction: float) -> None:
    """Straight lines there, and 1 % of a cell at rest between velocities continued from both sides, left 0.2 %."""
    recording = swinging(100.0, friction=friction)
    never = np.zeros(len(recording), dtype=bool)
    test_functions = Functions(recording, 16, never, over_cells=over_cells)
    quadrature = Quadrature.of(recording, recording.velocity, never)
    assert len(quadrature.cell) == 32
    motion = mean_velocity(recording, recording["position"]) if over_cells else recording.velocity
    points = quadrature.recording
    opposing = friction * test_functions.torques(quadrature, np.sign(points.velocity)[None])[0]
    impulse, change = test_functions.driving(quadrature, points.torque) - opposing, test_functions.momentum(motion)
    phase = 2 * np.pi * 2.0 / 100.0
    assert np.sqrt(np.mean((impulse - change) ** 2) / np.mean(change**2)) < 0.1 * phase**2 / 12


@pytest.mark.parametrize("lasts", [0.0, 0.6])
def test_a_standstill_between_two_samples_is_as_long_as_both_slopes_say(lasts: float) -> None:
    """Velocities that run to zero on straight lines leave no doubt about where."""
    time = np.arange(12.0)
    before, after = np.minimum(time - 5.2, 0.0), np.maximum(time - 5.2 - lasts, 0.0)
    velocity = before + after
    channels = {"time": time, "torque": np.ones(12), "velocity": velocity}
    recording = Recording("stops", Motion.ROTARY, channels, np.zeros(12, dtype=np.int64))
    found = Quadrature.of(recording, velocity, np.zeros(12, dtype=bool))
    assert found.moving_time[5] == pytest.approx(1.0 - lasts)
