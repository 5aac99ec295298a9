"""What a study says of a drive whose best compensation is known, and a leaderboard that ranks by it."""

from __future__ import annotations

import json
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from fricmodels.compensation import COULOMB, IMPROVED, NONE, TRUE, study
from fricmodels.compensation.present import show
from fricmodels.errors import InputError
from fricmodels.rig import Rig
from fricmodels.tournament.config import load_config
from fricmodels.tournament.running import run
from fricmodels.tracking import Settings

CLEAN = {
    "name": "clean",
    "inertia": 1.0,
    "friction": {"viscous": 1.0, "coulomb": 8.0},
    "excitation": {"kind": "tracking", "velocity": 1.5, "frequency": 0.5, "lines": 3, "bandwidth": 8.0},
    "sensors": {"velocity_noise_percent": 0.5},
    "rate": 500,
    "samples": 6000,
}


@pytest.mark.long
def test_where_nothing_is_hidden_nothing_more_is_to_be_had() -> None:
    found = study(Rig.model_validate(CLEAN), Settings(motion="trapezoid"), motions=2)
    assert [way.name for way in found.ways] == [NONE, COULOMB, IMPROVED, TRUE]
    assert found.best is found.way(IMPROVED)
    assert found.named == ()
    assert found.way(IMPROVED).rms_error == found.way(COULOMB).rms_error < 0.05 * found.way(NONE).rms_error
    assert found.way(TRUE).rms_error <= 1.5 * found.way(COULOMB).rms_error
    whole, least, most = found.best.over(found.way(NONE))
    assert least <= whole <= most


@pytest.mark.long
def test_it_is_the_same_again() -> None:
    rig = Rig.model_validate({**CLEAN, "samples": 2000})
    one, other = (study(rig, Settings(motion="trapezoid"), motions=1) for _ in range(2))
    assert one.ways == other.ways


@pytest.mark.long
def test_a_swing_at_the_measured_motion_is_explained() -> None:
    """The loop goes through the model there, and not along the reference; the words say so."""
    rig = Rig.model_validate({**CLEAN, "samples": 2000})
    told = {}
    for at in ("measured", "reference"):
        found = study(rig, Settings(motion="trapezoid", at=at), motions=1)
        swinging = replace(found.best, figures=(replace(found.best.figures[0], limit_cycle=True),))
        again = replace(found, ways=(*found.ways[:-2], swinging, found.ways[-1]))
        console = Console(width=200, record=True, file=StringIO())
        show(console, [again], ["rig.yaml"])
        show(console, [again, again], ["rig.yaml"] * 2)
        told[at] = console.export_text()
    assert told["measured"].count("--at reference has no such loop") == 2
    assert "--at reference" not in told["reference"]


def test_a_leaderboard_ranks_by_it(tmp_path: Path) -> None:
    cogging = {"name": "cogging", "harmonics": [{"order": 9.0, "amplitude": 2.0, "phase": 0.4}]}
    (tmp_path / "rig.yaml").write_text(json.dumps({**CLEAN, "effects": [cogging]}), encoding="utf-8")
    models = ["coulomb-viscous", "coulomb-viscous+cogging"]
    config = {
        "name": "worth",
        "datasets": [{"rig": "rig.yaml", "inertia": 1.0}],
        "models": models,
        "estimators": "batch",
        "score": "tracking",
        "simulate": False,
    }
    (tmp_path / "worth.yaml").write_text(json.dumps(config), encoding="utf-8")
    board = run(tmp_path / "worth.yaml", tmp_path / "out", executor="serial")
    assert [row["model"] for row in board.rows] == models[::-1]
    best, other = board.rows
    assert best["tracking_error_percent"] < 0.2 * other["tracking_error_percent"] < 10.0
    assert best["tracking_limit_cycle"] == 0.0
    assert best["tracking_error"] > 0


def test_only_simulated_drives_can_be_driven(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("datasets: [{files: a.csv}]\nscore: tracking\n", encoding="utf-8")
    with pytest.raises(InputError, match="give every dataset a 'rig'"):
        load_config(tmp_path / "a.yaml")
