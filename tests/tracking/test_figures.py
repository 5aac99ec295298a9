"""What counts as a limit cycle, and what does not."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.tracking.figures import figures, turns

TIME = np.arange(2000) / 1000
STEP = 1e-4


@pytest.mark.parametrize(
    ("motion", "swings"),
    [
        (lambda t: 0 * t, False),
        (lambda t: 0.002 * np.sin(60 * t), True),
        (lambda t: 0.4 * STEP * np.sin(60 * t), False),  # less than the encoder shows
        (lambda t: 0.05 * np.exp(-3 * t) * np.sin(60 * t), False),  # dying out
        (lambda t: 0.01 * np.exp(-t), False),  # creeping
        (lambda t: 0.005 * t + 0.4 * STEP * np.sin(60 * t), False),  # creeping in steps that cannot be seen
        (lambda t: np.where(np.sin(60 * t) > 0, 0.001, -0.001) + 1e-5 * np.sin(60 * t), True),
        (lambda t: 1e3 * t**9 * np.nan, True),  # gone
    ],
    ids=["still", "swinging", "within a count", "dying out", "creeping", "creeping in steps", "jumping", "lost"],
)
def test_rest(motion: object, swings: bool) -> None:
    position = motion(TIME)  # type: ignore[operator]
    found = figures(np.zeros_like(TIME), position, np.zeros_like(TIME), 0, STEP, 1e-9)
    assert found.limit_cycle is swings
    if np.all(np.isfinite(position)):
        assert found.rest_span == pytest.approx(np.ptp(position[1000:]))
        assert found.rest_counts == pytest.approx(found.rest_span / STEP)


def test_errors_and_effort() -> None:
    wanted, torque = np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, -1.0, 1.0, -1.0])
    found = figures(wanted, wanted - [0.0, 0.0, 2.0, 0.0], torque, 4, 0.0, 1e-9)
    assert (found.rms_error, found.largest_error) == (1.0, 2.0)
    assert (found.rms_torque, found.rms_torque_change) == (1.0, 2.0)
    assert np.isnan(found.rest_counts)


def test_turns_are_counted_beyond_a_size() -> None:
    wave = np.sin(np.linspace(0, 10 * np.pi, 1000))
    assert turns(wave, 0.5) == 10
    assert turns(wave + 0.1 * np.sin(np.linspace(0, 300, 1000)), 0.5) == 10
    assert turns(wave, 2.1) == 0
    assert turns(-wave, 0.5) == 10
