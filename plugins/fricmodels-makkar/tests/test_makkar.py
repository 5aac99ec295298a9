"""The law against its published properties."""

from __future__ import annotations

import numpy as np
import pytest
from fricmodels_makkar import MakkarDixonSawyerHu

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.testing import LawExam

VALUES = {"gamma_1": 0.25, "gamma_2": 100.0, "gamma_3": 10.0, "gamma_4": 0.1, "gamma_5": 100.0, "gamma_6": 0.01}
"""The coefficients of Fig. 1 of the paper."""


def torque(velocity: list[float], **changed: float) -> np.ndarray:
    """Return the law's torque at some velocities."""
    speeds = np.asarray(velocity, dtype=float)
    channels = {"time": np.arange(len(speeds), dtype=float), "torque": np.zeros(len(speeds)), "velocity": speeds}
    recording = Recording("grid", Motion.ROTARY, channels, np.zeros(len(speeds), dtype=np.int64))
    return Drive(Model(MakkarDixonSawyerHu()), 1.0).friction(recording, {**VALUES, **changed})


def test_the_published_formula() -> None:
    """Equation 1 of the paper, written out."""
    speeds = np.linspace(-2, 2, 101)
    expected = 0.25 * (np.tanh(100 * speeds) - np.tanh(10 * speeds)) + 0.1 * np.tanh(100 * speeds) + 0.01 * speeds
    assert torque(list(speeds)) == pytest.approx(expected, abs=1e-12)


def test_symmetric_and_zero_at_rest() -> None:
    """Nothing is held at rest."""
    assert torque([0.0])[0] == 0.0
    assert torque([-0.3]) == pytest.approx(-torque([0.3]))


def test_limits() -> None:
    """Viscous far from rest; Coulomb plus viscous where the peak has gone; a peak near γ1 + γ4 at low speed."""
    assert torque([1e3])[0] == pytest.approx(0.1 + 0.01 * 1e3)
    assert torque([2.0], gamma_6=0.0)[0] == pytest.approx(0.1, rel=1e-6)
    peak = torque(list(np.linspace(0, 0.2, 2001))).max()
    assert 0.25 < peak < 0.35


def test_units_follow_the_motion() -> None:
    """Metres for a linear axis."""
    units = {p.symbol: p.unit_for(Motion.LINEAR) for p in MakkarDixonSawyerHu.parameters}
    assert units == {
        "gamma_1": "N", "gamma_2": "s/m", "gamma_3": "s/m", "gamma_4": "N", "gamma_5": "s/m", "gamma_6": "N s/m",
    }  # fmt: skip


class TestExam(LawExam):
    """The exam of laws, on a drive whose peak and whose Coulomb torque rise at speeds that can be told apart."""

    term = MakkarDixonSawyerHu
