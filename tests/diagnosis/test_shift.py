"""A shift of torque against motion within a sample is not named, and is said where the error falls without it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.shift import shift_within_sampling
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.report.answer import answer

STEP, INERTIA, VISCOUS, COULOMB = 0.004, 7.4e-4, 1.5e-3, 0.02
LINES = ((2.3, 9.0), (4.7, 7.0), (7.9, 5.0))


def recorded(late: float, *, seed: int = 1) -> Recording:
    """Return a drive in closed form whose motion is recorded late [s], with noise of a thousandth."""
    time = STEP * np.arange(3000.0)
    rng = np.random.default_rng(seed)

    def velocity(t: np.ndarray) -> np.ndarray:
        return sum((size * np.sin(2 * np.pi * f * t + f) for f, size in LINES), np.zeros_like(t))

    fine = np.linspace(-1.0, time[-1] + 1.0, 200_000)
    acceleration = CubicSpline(fine, velocity(fine)).derivative()
    torque = INERTIA * acceleration(time) + VISCOUS * velocity(time) + COULOMB * np.sign(velocity(time))
    channels = {
        "time": time,
        "velocity": velocity(time - late) + 1e-2 * rng.standard_normal(len(time)),
        "torque": torque + 1e-4 * rng.standard_normal(len(time)),
    }
    return Recording("late", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("late", [0.5, pytest.param(-0.5, marks=pytest.mark.long)])
def test_a_shift_of_half_a_sample_is_said_and_no_effect_is_named(late: float) -> None:
    found = diagnose(recorded(late * STEP), "coulomb-viscous", INERTIA)
    data = document(found)
    assert data.verdict == "adequate"
    assert data.shift is not None
    assert data.shift.samples == pytest.approx(late, abs=0.05)
    assert data.shift.seconds == pytest.approx(late * STEP, abs=0.05 * STEP)
    assert data.shift.held_out_percent is not None
    assert data.rms_torque_error.held_out_percent is not None
    assert data.shift.held_out_percent < 0.5 * data.rms_torque_error.held_out_percent
    longer = replace(found, policy=replace(found.policy, within_sampling=0.3))
    assert shift_within_sampling(longer) is None, "sampling does not make so much"
    said = answer(data)
    first, second = ("motion", "torque") if late > 0 else ("torque", "motion")
    words = rf"The {first} was recorded (2|1\.9|2\.1) ms \(0\.(5|4[6-9]|5[1-4]) samples\) after the {second}, "
    assert re.match(words, said.next)
    assert f"--model {data.shift.model}" in said.command


def test_without_a_shift_none_is_said() -> None:
    data = document(diagnose(recorded(0.0), "coulomb-viscous", INERTIA))
    assert data.verdict == "adequate"
    assert data.shift is None
    assert "recorded" not in answer(data).next
