"""A torque that comes and goes in time, whatever the drive does, is no friction and no inertia."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.sought_functions import frequency
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.results.words import LINE
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.shifted import regression_of

PUMP, SIZE = 1.7, 0.3


def swung(frequencies: tuple[float, ...], pump: float = PUMP, size: float = SIZE, seed: int = 0) -> Recording:
    """A joint of 0.5 kg m² with friction that is moved by some sines, beside a pump, with noise of 0.3 %."""
    rng, time = np.random.default_rng(seed), np.arange(20_000) / 250.0
    turns = 2.0 * np.pi * np.array(frequencies)[:, None]
    phase = turns * time + np.arange(len(frequencies))[:, None]
    velocity = np.sum(np.cos(phase), axis=0)
    acceleration = np.sum(-turns * np.sin(phase), axis=0)
    torque = 0.5 * acceleration + 0.8 * velocity + 1.5 * np.sign(velocity)
    torque += size * np.sin(2.0 * np.pi * pump * time + 0.4) + 0.01 * rng.standard_normal(len(time))
    channels = {
        "time": time,
        "torque": torque,
        "velocity": velocity + 2e-4 * rng.standard_normal(len(time)),
        "position": np.sum(np.sin(phase) / turns, axis=0),
    }
    return Recording("pump", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.long
def test_its_frequency_is_told_and_no_effect_is_named() -> None:
    found = diagnose(swung((0.31, 0.77, 1.19)), "coulomb-viscous", 0.5)
    assert found.verdict == "unknown-effect"
    assert not found.findings
    assert found.view is not None
    assert found.view.channels == f"{LINE} 1.7 Hz"


@pytest.mark.long
def test_without_it_the_model_is_adequate() -> None:
    assert diagnose(swung((0.31, 0.77, 1.19), size=0.0), "coulomb-viscous", 0.5).verdict == "adequate"


@pytest.mark.parametrize(("moved", "expected"), [((0.5,), 0.0), ((0.31, 0.77, 1.19), 1.5)])
def test_what_the_motion_itself_repeats_is_no_line(moved: tuple[float, ...], expected: float) -> None:
    """1.5 Hz is the third harmonic of a motion of 0.5 Hz: any friction has it there, and not beside other sines."""
    recording = ready(swung(moved, pump=1.5))
    rows, fitted = estimate(Drive(Model.parse("coulomb-viscous"), 0.5), recording)
    told = frequency(rows, regression_of(rows, fitted.parameters), POLICY)
    if expected:
        assert told == pytest.approx(expected, rel=1e-3)
    else:
        assert min(abs(told * 2.0 - np.rint(told * 2.0)), 1.0) > 2.0 / 80.0


def test_a_line_of_the_motion_is_none_though_it_does_not_repeat() -> None:
    """What is wrong at a frequency of the motion may be of the motion: another inertia would be so."""
    recording = ready(swung((0.31, 0.77, 1.19), pump=0.77))
    rows, fitted = estimate(Drive(Model.parse("coulomb-viscous"), 0.5), recording)
    told = frequency(rows, regression_of(rows, fitted.parameters), POLICY)
    assert abs(told - 0.77) > 0.01
