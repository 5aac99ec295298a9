"""What the diagnosis does on recordings of ten seconds: joints 1 and 6 of the KR300."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from fricmodels.diagnosis import Comparison, compare, compare_model, diagnose, kept_back, ready
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.tournament import load_config

ROOT = Path(__file__).parents[2]
DATA = ROOT.parent / "shared" / "data"

pytestmark = [
    pytest.mark.measured,
    pytest.mark.skipif(not (DATA / "kuka_kr300").is_dir(), reason="../shared/data/kuka_kr300 is not there"),
]


@pytest.fixture(scope="module")
def story(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    """Return the module that reads the joints."""
    return from_benchmarks("measured.kuka")


@pytest.mark.long
def test_no_effect_is_named_on_ten_seconds(story: ModuleType) -> None:
    """Three to five reversals, while five other joints move: nothing there can be held against blocks kept back."""
    diagnosis = diagnose(story.recording(DATA, 1, "A"), Model.parse("coulomb-viscous"))
    assert not diagnosis.findings


def test_what_joint_6_lacks_on_ten_seconds_lowers_the_error_on_two_other_trajectories(story: ModuleType) -> None:
    """A falling friction that follows late, fitted to A alone: 21 to 15 % on B, 13 to 8 % on C."""
    recordings = {trajectory: story.recording(DATA, 6, trajectory) for trajectory in "ABC"}
    diagnosis = diagnose(recordings["A"], Model.parse("coulomb-viscous"))
    assert "frictional-lag" in diagnosis.findings[0].names
    fitted = [compare(recordings["A"], model) for model in ("coulomb-viscous", "coulomb-viscous+frictional-lag")]
    for other in "BC":
        measured = compare(recordings[other], "coulomb-viscous").problem.recording
        without, behind = (unexplained(comparison, measured) for comparison in fitted)
        assert behind < 0.85 * without


def unexplained(comparison: Comparison, measured: Recording) -> float:
    """Return the RMS torque that a model leaves where a joint moves, averaged over nine samples, over that of all."""
    values, drive = comparison.estimate.parameters, comparison.drive
    inertia = values[drive.inertia_key] * measured["acceleration"]
    left = measured.torque - inertia - drive.friction(measured, values)
    moving = np.abs(measured.velocity) > 0.02 * measured.peak_speed
    return float(np.sqrt(np.mean(np.convolve(left, np.ones(9) / 9, "same")[moving] ** 2) / np.mean(measured.torque**2)))


def test_joint_6_is_the_same_on_three_trajectories(story: ModuleType) -> None:
    """Inertia, viscous and Coulomb friction agree between A, B and C to a tenth or so."""
    values = []
    for trajectory in "ABC":
        recording = ready(story.recording(DATA, 6, trajectory))
        train, test = kept_back(recording)
        values.append(compare_model(train, test, Drive(Model.parse("coulomb-viscous"))).estimate.parameters)
    for key, wanted in (("J", 76.0), ("K_v", 360.0), ("K_c", 104.0)):
        assert [value[key] for value in values] == pytest.approx([wanted] * 3, rel=0.15)


@pytest.mark.parametrize("name", ["emps", "tx40", "xl330", "kuka"])
def test_configurations_are_valid(name: str) -> None:
    """Every name in them is known."""
    assert load_config(ROOT / "configs" / "measured" / f"{name}.yaml").datasets
