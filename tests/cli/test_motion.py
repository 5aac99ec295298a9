"""Simulated motion on the command line and in tournaments, from a file to its answer; and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels import load
from fricmodels.cli import main
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.simulation import simulate

TRUE = {"J": 0.01, "K_v": 0.05, "K_c": 0.03}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of a drive with more friction forwards; the velocity was not measured."""
    time = np.arange(8000) * 1e-3
    torque = 0.15 * np.sin(3.0 * time) + 0.08 * np.sin(7.1 * time + 1.0)
    drive = Drive(Model.parse("coulomb-viscous+asymmetry"))
    made = simulate(drive, {**TRUE, "asymmetry.c": 0.0, "asymmetry.d": 0.02}, time, torque, with_position=True)
    position = made["position"] + 2e-5 * np.random.default_rng(0).standard_normal(8000)
    path = tmp_path_factory.mktemp("motion") / "drive.csv"
    table = {"time_s": time, "torque_Nm": torque, "position_rad": position, "reference": np.sin(time)}
    pd.DataFrame(table).to_csv(path, index=False)
    pd.DataFrame({k: v for k, v in table.items() if k != "position_rad"} | {"velocity_rad_s": made.velocity}).to_csv(
        path.parent / "speed.csv", index=False
    )
    return path


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    shown = capsys.readouterr()
    return int(stopped.value.code or 0), shown.out, shown.err


def test_compare_shows_and_writes_the_simulated_motion(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.html"
    arguments = ["--model", "coulomb-viscous", "--score", "position", "--out", str(tmp_path), "--report", str(page)]
    code, out, _ = run(capsys, "compare", str(data), *arguments)
    assert code == 0
    assert "Simulated from the measured torque" in out
    document = json.loads((tmp_path / "motion.json").read_text())
    assert (document["schema"], document["unit"], document["loop"]) == ("fricmodels/motion/1", "rad", "open")
    (row,) = document["rows"]
    assert row["test"]["position"] < 1.2 * row["by_torque"]["position"]
    text = page.read_text()
    assert 'id="motion"' in text
    assert "Simulated beside measured motion" in text


def test_a_fit_to_the_motion_is_kept(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "drive.model.json"
    arguments = ["--model", "coulomb-viscous+asymmetry", "--objective", "position", "--out", str(out)]
    code, _, _ = run(capsys, "fit", str(data), *arguments)
    assert code == 0
    kept = load(out)
    for key, value in {**TRUE, "asymmetry.d": 0.02}.items():
        assert kept.parameters[key] == pytest.approx(value, rel=0.05)
        assert 0 < kept.standard_errors[key] < 0.2 * value


@pytest.mark.long
def test_numbers_that_are_held_are_not_fitted_to_the_motion(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is added to them is: the asymmetry, with all the rest."""
    held = tmp_path / "held.model.json"
    assert run(capsys, "fit", str(data), "--model", "coulomb-viscous", "--out", str(held))[0] == 0
    arguments = ["--model", str(held), "--fixed", "--score", "position", "--out", str(tmp_path)]
    assert run(capsys, "improve", str(data), *arguments)[0] == 0
    first, *_, last = json.loads((tmp_path / "motion.json").read_text())["rows"]
    assert (first["parameters"], first["test"], first["chosen"]) == (None, None, False)
    assert last["chosen"]
    assert last["test"]["position"] < 0.5 * first["by_torque"]["position"]
    found = load(tmp_path / "model.json").parameters
    assert {key: found[key] for key in last["parameters"]} == last["parameters"]


@pytest.mark.long
def test_a_tournament_is_ranked_by_the_simulated_position(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    config = tmp_path / "t.yaml"
    config.write_text(
        f"datasets: [{{files: {data}}}]\nmodels: [coulomb-viscous, coulomb-viscous+asymmetry]\n"
        "estimators: [batch, {name: batch, label: by motion, settings: {objective: position}}]\n"
        "score: position\njobs: 1\n"
    )
    code, out, _ = run(capsys, "run", str(config), "--out", str(tmp_path / "o"), "--jobs", "1")
    assert code == 0
    assert "simulated" in out
    rows = json.loads((tmp_path / "o" / "leaderboard.json").read_text())["rows"]
    errors = [row["simulated_position_error"] for row in rows]
    assert errors == sorted(errors)
    assert rows[0]["model"] == "coulomb-viscous+asymmetry"
    assert all(row["simulated_velocity_error"] > 0 for row in rows)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--score", "position", "--horizon", "0"], "--horizon"),
        (["--horizon", "10"], "--score position"),
        (["--score", "place"], "place"),
        (["--score", "position", "--controller", "missing.yaml"], "missing.yaml"),
        (["--score", "position", "--controller", "typo.yaml"], "gain"),
        (["--score", "position", "--controller", "good.yaml"], "other.reference"),
    ],
)
def test_wrong_options_are_one_line(
    arguments: list[str], word: str, data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("typo.yaml").write_text("kind: pd\nreference: reference\ngian: 3\n")
    Path("good.yaml").write_text("kind: pd\nreference: reference\ngain: 3\n")
    code, _, error = run(capsys, "compare", str(data), "--model", "coulomb-viscous", *arguments)
    assert code == 2
    assert word in error
    assert "Traceback" not in error


def test_without_a_position_there_is_no_score_by_it(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    speed = data.parent / "speed.csv"
    code, _, error = run(capsys, "compare", str(speed), "--model", "coulomb-viscous", "--score", "position")
    assert (code, "--column position=" in error) == (2, True)
    config = tmp_path / "t.yaml"
    for text, word in (("score: position\n", "position"), ("horizon: 10\n", "score: position")):
        config.write_text(f"datasets: [{{files: {speed}}}]\nmodels: [coulomb-viscous]\nestimators: [batch]\n{text}")
        code, _, error = run(capsys, "run", str(config), "--out", str(tmp_path / "o"))
        assert (code, word in error) == (2, True)


def test_a_controller_in_yaml_drives_the_simulation(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    controller = tmp_path / "pd.yaml"
    controller.write_text("kind: pd\nreference: reference\ngain: 3\nderivative: 0.1\n")
    arguments = ["--score", "position", "--column", "other.reference=reference:rad", "--controller", str(controller)]
    code, out, error = run(capsys, "compare", str(data), "--model", "coulomb-viscous", *arguments)
    assert (code, error) == (0, error)
    assert "through the controller" in out


@pytest.mark.long
def test_improve_keeps_the_rung_that_simulates_best(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--model", "coulomb-viscous", "--score", "position", "--out", str(tmp_path)]
    code, out, _ = run(capsys, "improve", str(data), *arguments)
    assert code == 0
    assert "taken" in out
    assert load(tmp_path / "model.json").name == "coulomb-viscous+asymmetry"
    rows = json.loads((tmp_path / "motion.json").read_text())["rows"]
    assert [row["chosen"] for row in rows][-1]
