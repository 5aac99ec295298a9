"""Whole tournaments, from the files under ``configs/`` to the ranked leaderboard."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fricmodels.tournament import load_config, run
from fricmodels.tournament.config import Config
from fricmodels.tournament.demonstration import MOTOR

CONFIGS = Path(__file__).parents[2] / "configs"
EMPS = CONFIGS.parent.parent / "shared" / "data" / "emps"
ERROR = "held_out_rms_torque_error_percent"


def test_quick(tmp_path: Path) -> None:
    """The law that the motor has wins at every noise level, and its coefficients are found."""
    board = run(load_config(CONFIGS / "quick.yaml"), tmp_path, executor="serial")
    assert len(board.rows) == 2 * 2 * 3
    assert not board.failures
    for medians in (board.summary()[:2], board.summary(ERROR)[:2]):
        assert {row["model"] for row in medians} == {"asymmetric-coulomb-viscous"}
    clean = next(row for row in board.rows if row["tags"]["noise_percent"] == 0)
    for key, true in MOTOR["parameters"].items():  # type: ignore[attr-defined]
        assert clean["parameters"][key] == pytest.approx(true, rel=0.05)
        assert clean["true_parameters"][key] == true
        assert clean["standard_errors"][key] > 0
    written = json.loads((tmp_path / "leaderboard.json").read_text())
    assert written["rows"] == list(board.rows)


def test_paper_score_is_of_what_was_fitted(tmp_path: Path) -> None:
    dataset = {"name": "motor", "simulate": {**MOTOR, "noise_percent": 0}}
    config = Config.model_validate(
        {"datasets": [dataset], "models": "asymmetric-coulomb-viscous", "estimators": "batch", "score": "paper"}
    )
    (row,) = run(config, tmp_path, executor="serial").rows
    assert row["status"] == "ok"
    assert row[ERROR] is None
    assert 0 < row["rms_torque_error_percent"] < 5
    assert row["measure"] == "paper"


def test_a_rig_takes_part(tmp_path: Path) -> None:
    (tmp_path / "rig.yaml").write_text(
        "inertia: 4.87e-6\nfriction: {viscous: 1.0e-4, coulomb: 1.0e-2}\neffects: [{name: gravity, sine: 0.003}]\n"
        "excitation: {kind: tracking, velocity: 20, frequency: 0.5, bandwidth: 20}\nrate: 1000\nsamples: 4000\n"
    )
    config = {
        "datasets": [{"rig": "rig.yaml", "inertia": 4.87e-6, "seeds": [1, 2]}],
        "models": ["coulomb-viscous", "coulomb-viscous+gravity"],
        "estimators": "batch",
        "simulate": False,
    }
    board = run(Config.model_validate(config), tmp_path / "out", directory=tmp_path, executor="serial")
    assert [row["model"] for row in board.rows[:2]] == ["coulomb-viscous+gravity"] * 2
    assert [row["tags"]["seed"] for row in board.rows[:2]] in ([1, 2], [2, 1])
    assert board.rows[1][ERROR] < 0.5 * board.rows[2][ERROR]


@pytest.mark.measured
@pytest.mark.skipif(not EMPS.is_dir(), reason="the measurements of EMPS are not beside the project")
def test_emps_against_its_published_reference(tmp_path: Path) -> None:
    """Janot, Gautier and Brunot (2019): 4.0834 % and 3.1117 % fitted, 5.9824 % on the pulses; M, F_v, F_c, offset."""
    config = load_config(CONFIGS / "emps.yaml")
    models = ["coulomb-viscous+torque-offset", "asymmetric-coulomb-viscous"]
    chosen = Config.model_validate({**config.model_dump(), "models": models, "estimators": "batch"})
    board = run(chosen, tmp_path, directory=CONFIGS, executor="serial")
    asymmetric, symmetric = (next(row for row in board.rows if row["model"] == name) for name in reversed(models))
    found = symmetric["parameters"]
    assert found["M"] == pytest.approx(95.1089, rel=0.02)
    assert found["K_v"] == pytest.approx(203.5034, rel=0.02)
    assert found["K_c"] == pytest.approx(20.3935, rel=0.02)
    assert found["torque-offset.tau_0"] == pytest.approx(-3.1648, rel=0.02)
    assert symmetric["rms_torque_error_percent"] <= 4.08
    assert symmetric[ERROR] <= 5.98
    assert asymmetric["rms_torque_error_percent"] <= 3.11


@pytest.mark.long
def test_dask_gives_the_same_rows(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    import subprocess
    import sys

    rows = []
    for executor in ("serial", "dask"):
        out = tmp_path / executor
        command = [sys.executable, "-m", "fricmodels", "run", str(CONFIGS / "quick.yaml"), "--out", str(out)]
        subprocess.run([*command, "--executor", executor, "--jobs", "2"], check=True, capture_output=True, timeout=300)
        board = json.loads((out / "leaderboard.json").read_text())["rows"]
        rows.append([{key: value for key, value in row.items() if key not in ("seconds", "key")} for row in board])
    assert rows[0] == rows[1]


@pytest.mark.long
def test_the_demonstration_ranks_the_true_law_first(tmp_path: Path) -> None:
    board = run(load_config(CONFIGS / "demo.yaml"), tmp_path, processes=2)
    assert board.rows[0]["model"] in {"asymmetric-coulomb-viscous", "asymmetric-exponential-stick-slip"}
    assert len(board.failures) <= 2
