"""Errors are in the torque as it was recorded: a torque constant that is off does not scale them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from tests.test_inertial_torque import positions

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import filtered_torque_error, torque_error
from fricmodels.score.bands import torque_errors
from fricmodels.score.proportional import in_recorded_torque, recorded_inertia
from fricmodels.split import split
from fricmodels.weakform.prepared import ready

Made = Callable[..., Recording]
GAIN, INERTIA = 0.25, 2.0
LAW = {"K_v": 0.5, "K_c": 3.0}
TRUE = Drive(Model.parse("coulomb-viscous+torque-gain"), INERTIA)
WITH_GAIN = {**LAW, "torque-gain.g": GAIN}
EQUAL = Drive(Model.parse("coulomb-viscous"), INERTIA / (1 + GAIN))
WITHOUT_GAIN = {key: value / (1 + GAIN) for key, value in LAW.items()}


def accelerations(recording: Recording) -> Recording:
    """Return the same motion with an acceleration that was measured."""
    slope = np.gradient(recording["velocity"], recording.time)
    channels = {**{k: recording[k] for k in ("time", "torque", "velocity")}, "acceleration": slope}
    return Recording("accelerations", recording.motion, channels, recording.run)


@pytest.mark.parametrize("of", [Recording.remembering, positions, accelerations], ids=lambda f: f.__name__)
def test_a_gain_leaves_the_error_of_its_equal_with_another_inertia(
    made: Made, of: Callable[[Recording], Recording]
) -> None:
    """(1 + g) τ = J a + τ_F and τ = (J a + τ_F)/(1 + g) are one statement, and have one error, and one noise."""
    train, test = split(ready(of(made())))
    one, error_of_one = torque_errors(TRUE, WITH_GAIN, train, test)
    two, error_of_two = torque_errors(EQUAL, WITHOUT_GAIN, train, test)
    for a, b in zip(one.bands, two.bands, strict=True):
        assert a.percent == pytest.approx(b.percent, rel=1e-6)
        assert a.held_out_percent == pytest.approx(b.held_out_percent, rel=1e-6)
        assert a.noise_floor_percent == pytest.approx(b.noise_floor_percent, rel=1e-9)
    np.testing.assert_allclose(error_of_one, error_of_two, atol=1e-9)
    for part in (train, test):
        for left in (torque_error, filtered_torque_error):
            np.testing.assert_allclose(left(TRUE, WITH_GAIN, part), left(EQUAL, WITHOUT_GAIN, part), atol=1e-9)


def test_a_gain_that_takes_the_torque_away_leaves_no_small_error(made: Made) -> None:
    """With g = −0.9 and all else a tenth as large the same is left of what was recorded."""
    train, test = split(ready(made()))
    drive, tenth = Drive(Model.parse("coulomb-viscous+torque-gain")), {key: 0.1 * value for key, value in LAW.items()}
    before, _ = torque_errors(drive, {**LAW, "J": 1.6, "torque-gain.g": 0.0}, train, test)
    after, _ = torque_errors(drive, {**tenth, "J": 0.16, "torque-gain.g": -0.9}, train, test)
    assert after.headline.held_out_percent == pytest.approx(before.headline.held_out_percent, rel=1e-9)


def test_what_a_model_says_of_the_recorded_torque() -> None:
    assert in_recorded_torque(EQUAL, WITHOUT_GAIN) == 1.0
    assert in_recorded_torque(TRUE, WITH_GAIN) == pytest.approx(0.8)
    assert in_recorded_torque(TRUE, {**LAW, "torque-gain.g": -1.0}) == float("inf")
    assert recorded_inertia(TRUE, WITH_GAIN) == pytest.approx(1.6)
    both = Drive(Model.parse("coulomb-viscous+torque-gain+inertia-error"), INERTIA)
    assert recorded_inertia(both, {**WITH_GAIN, "inertia-error.dJ": 0.5}) == pytest.approx(2.0)
