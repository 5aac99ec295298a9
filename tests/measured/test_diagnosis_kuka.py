"""What the diagnosis does on a recording that is too short to name anything: joints 1 and 6 of the KR300."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from fricmodels.diagnosis import compare_model, diagnose, kept_back, ready
from fricmodels.drive import Drive
from fricmodels.model import Model
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


@pytest.mark.parametrize("joint", [pytest.param(1, marks=pytest.mark.long), 6])
def test_no_effect_is_named_on_ten_seconds(story: ModuleType, joint: int) -> None:
    """Three to five reversals, while five other joints move: nothing there can be held against blocks kept back."""
    diagnosis = diagnose(story.recording(DATA, joint, "A"), Model.parse("coulomb-viscous"))
    assert not diagnosis.findings


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
