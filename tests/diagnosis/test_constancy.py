"""What is there has one size all over the motion; an offset that stands for a torque of |acceleration| has not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.constancy import gain_of_own_sizes
from fricmodels.diagnosis.effect_set import nothing
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate

INERTIA = 0.2


def moved(offset: float, of_acceleration: float) -> Recording:
    """Return a drive in motion of four frequencies, with an offset and a torque of |acceleration|."""
    rng = np.random.default_rng(3)
    time = np.arange(8000) / 500.0
    waves = [(2.0, 1.1, 0.0), (1.3, 2.9, 1.0), (0.7, 6.1, 2.0), (0.5, 11.3, 0.5)]
    velocity = sum(a * np.sin(w * time + p) for a, w, p in waves)
    acceleration = sum(a * w * np.cos(w * time + p) for a, w, p in waves)
    position = sum(-a / w * np.cos(w * time + p) for a, w, p in waves)
    friction = 1.5 * np.sign(velocity) + 0.4 * velocity + offset + of_acceleration * np.abs(acceleration)
    channels = {
        "time": time,
        "velocity": velocity + 0.005 * rng.standard_normal(len(time)),
        "torque": INERTIA * acceleration + friction,
        "position": position,
    }
    return Recording("moved", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize(("offset", "of_acceleration"), [(0.5, 0.0), (0.0, 0.06)])
def test_own_sizes_gain_where_the_effect_only_resembles(offset: float, of_acceleration: float) -> None:
    from fricmodels.signals import prepare

    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), INERTIA), prepare(moved(offset, of_acceleration)))
    result = candidate_tests(problem, found.parameters, only=["torque-offset"])
    (tested,) = result.tested
    assert tested.evidence.explained > 0.4
    gain = gain_of_own_sizes(result, tested, nothing(result))
    assert gain < 0.02 if offset else gain > POLICY.own_sizes


def test_where_an_effect_does_nothing_it_has_no_size_to_compare() -> None:
    """Friction at low speed is not zero at high speed, but 1e-157 of a newton metre, whose square is no number."""
    from fricmodels.signals import prepare

    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), INERTIA), prepare(moved(0.5, 0.0)))
    result = candidate_tests(problem, found.parameters, only=["torque-offset"])
    (tested,) = result.tested
    speed = np.abs(problem.recording.velocity[np.clip(problem.centre, 0, len(problem.recording) - 1)])
    fades = np.where(speed > np.quantile(speed, 2 / 3), 1e-157, 1.0)
    fading = replace(tested, found=replace(tested.found, columns=tested.found.columns * fades))
    assert 0.0 <= gain_of_own_sizes(result, fading, nothing(result)) < 0.1
