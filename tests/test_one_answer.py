"""One question, one answer: tournament, comparison and ladder give the same numbers, to the last bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricmodels.diagnosis import Comparison, compare
from fricmodels.diagnosis.document import document
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.rig import load_rig, random_rig
from fricmodels.rig import write as write_recording
from fricmodels.tournament import run
from fricmodels.tournament.config import Config

ROOT = Path(__file__).parent.parent


def row_of(data: Path, model: str, inertia: float | None, folder: Path, **dataset: Any) -> dict[str, Any]:
    content = {
        "datasets": [{"name": "one", "files": str(data), "inertia": inertia, **dataset}],
        "models": [model],
        "estimators": "batch",
        "simulate": False,
    }
    board = run(Config.model_validate(content), folder / "run", directory=folder, executor="serial")
    (row,) = board.rows
    assert row["status"] == "ok", row["message"]
    return dict(row)


def assert_same(comparison: Comparison, row: dict[str, Any]) -> None:
    estimate, errors = comparison.estimate, comparison.errors
    assert dict(estimate.parameters) == row["parameters"]
    assert dict(estimate.standard_errors) == row["standard_errors"]
    assert dict(estimate.not_identified) == row["not_identified"]
    assert row["rms_torque_error"] == errors.SI
    assert errors.percent == row["rms_torque_error_percent"]
    assert errors.held_out_percent == row["held_out_rms_torque_error_percent"]


def written(recording: Recording, folder: Path) -> Path:
    return write_recording(recording, folder / "recording.csv")[0]


@pytest.mark.parametrize(
    ("inertia_is_given", "hold"),
    [
        (True, True),
        (False, False),
        *(pytest.param(*other, marks=pytest.mark.long) for other in ((True, False), (False, True))),
    ],
)
@pytest.mark.parametrize(
    ("effect", "model"),
    [
        ("gravity", "coulomb-viscous+gravity"),
        ("stribeck", "exponential-stick-slip"),
        ("cogging", "coulomb-viscous+cogging"),
        ("torque-offset", "square-root+torque-offset"),
    ],
)
def test_tournament_and_comparison(effect: str, model: str, inertia_is_given: bool, hold: bool, tmp_path: Path) -> None:
    rig = random_rig(np.random.default_rng([3, hold]), (effect,), samples=4000, scale="robot-joint")
    data = written(rig.model_copy(update={"hold": hold}).simulate(), tmp_path)
    inertia = rig.inertia if inertia_is_given else None
    assert_same(compare(read(data), model, inertia), row_of(data, model, inertia, tmp_path))


@pytest.mark.parametrize("path", sorted((ROOT / "configs" / "rigs").glob("*.yaml")), ids=lambda path: path.stem)
def test_rigs_of_the_configurations(path: Path, tmp_path: Path) -> None:
    rig = load_rig(path).model_copy(update={"samples": 5000, "runs": 1})
    data = written(rig.simulate(), tmp_path)
    motion = {"motion": rig.motion.value}
    recording = read(data, motion=rig.motion)
    row = row_of(data, "asymmetric-coulomb-viscous", rig.inertia, tmp_path, **motion)
    assert_same(compare(recording, "asymmetric-coulomb-viscous", rig.inertia), row)


def test_the_last_rung_of_the_demonstration_is_what_a_tournament_finds(tmp_path: Path, demonstration: Any) -> None:
    data, inertia, ladder = demonstration
    last = ladder.rungs[-1].comparison
    assert len(ladder.rungs) > 1
    row = row_of(data, last.drive.model.name, inertia, tmp_path)
    assert_same(last, row)
    assert_same(compare(read(data), last.drive.model, inertia), row)
    rung = json.loads(document(ladder.first, ladder).to_json())["ladder"][-1]
    assert rung["parameters"] == dict(last.estimate.parameters)
    assert rung["held_out_rms_percent"] == last.errors.held_out_percent
