"""An effect that makes the fit far worse where it was fitted is not named, though the test error falls."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels import compare
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.refits import Refits
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

J, K_V, K_C = 3.1e-3, 0.115, 0.3
_DT, _FINE, _LATE = 5e-3, 10, 24


def driven(torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return position and velocity of a drive that begins at rest, by small steps."""
    position, velocity, place, speed = np.empty(len(torque)), np.empty(len(torque)), 0.0, 0.0
    for k, push in enumerate(torque):
        for _ in range(_FINE):
            sticks = speed == 0.0 and abs(push) < K_C
            side = np.sign(speed if speed else push)
            rate = 0.0 if sticks else (push - K_C * side - K_V * speed) / J
            after = speed + rate * _DT / _FINE
            speed = 0.0 if speed * after < 0.0 else after
            place += speed * _DT / _FINE
        position[k], velocity[k] = place, speed
    return position, velocity


@pytest.fixture(scope="module")
def bench() -> Recording:
    """Return a bench test of a motor: a step back and a slow ramp forward; its velocity is a mean over 120 ms."""
    parts = []
    for run, torque in enumerate((np.full(154, -7.0), 0.25 * _DT * np.arange(4000))):
        position, velocity = driven(torque)
        late = np.convolve(np.r_[np.zeros(_LATE), velocity], np.ones(_LATE) / _LATE, "valid")[1:]
        parts.append(np.c_[torque, np.round(position, 4), np.round(late, 4), np.full(len(torque), run)][-154:])
    torque, position, velocity, run = np.concatenate(parts).T
    time = np.tile(_DT * np.arange(154), 2)
    channels = {"time": time, "torque": torque, "position": position, "velocity": velocity}
    return Recording("bench", Motion.ROTARY, channels, run.astype(np.int64))


def test_what_acts_in_samples_that_no_row_has_is_not_known_there(bench: Recording) -> None:
    """The step's first samples are at low speed: a stick torque of any size fits them, and 171 % is left of them."""
    here = compare(bench, "coulomb-viscous")
    refits = Refits(here, Policy())
    result = candidate_tests(here.problem, here.estimate.parameters)
    for tested in result.tested:
        there = refits.with_effect(tested)
        assert there is None or there.errors.percent < 2.0 * here.errors.percent, tested.name


def test_a_model_with_memory_begins_where_no_stroke_has_room_for_wide_test_functions(bench: Recording) -> None:
    """Its second start is sought through such; ``improve`` names it, and it can be fitted by itself too."""
    assert compare(bench, "coulomb-viscous+frictional-lag").estimate.parameters["frictional-lag.T"] > 0.0
