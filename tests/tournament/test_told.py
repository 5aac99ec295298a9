"""Mistakes in a tournament are answered with file, line and key, never with options of other commands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import main
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.score.cycles import last_cycles
from fricmodels.tournament import load_config, plan
from fricmodels.tournament.config import Config
from fricmodels.tournament.told import as_keys


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    time = 2e-3 * np.arange(2000)
    velocity = 3.0 * np.sin(4.0 * time) + np.sin(9.0 * time)
    torque = 0.1 * velocity + 0.5 * np.sign(velocity) + 0.2 * np.gradient(velocity, 2e-3)
    rows = np.column_stack([time, torque, velocity])
    for name, header in (("j", "time_s,torque_Nm,velocity_rad_s"), ("k", "time_s,torque_Nm,omega [foo]")):
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header=header, comments="")
    return tmp_path


HEAD = "name: t\nmodels: {models}\nestimators: batch\ndatasets:\n"


@pytest.mark.parametrize(
    ("datasets", "models", "line", "cause"),
    [
        ("  - files: jj.csv\n", "coulomb-viscous", 5, "there is no file 'jj.csv'"),
        ("  - files: j.csv\n  - name: r\n    rig: r.yaml\n", "coulomb-viscous", 7, "there is no such rig file"),
        (f"  - files: {300 * 'j'}.csv\n", "coulomb-viscous", 5, "there is no file 'jjj"),
        (f"  - files: j.csv\n  - name: r\n    rig: {300 * 'r'}.yaml\n", "coulomb-viscous", 7, "no such rig file"),
        (
            "  - name: a\n    files: j.csv\n  - files: k.csv\n    name: a\n",
            "coulomb-viscous",
            8,
            "two datasets",
        ),
        (
            "  - files: j.csv\n",
            "coulomb-viscous+load-friction",
            5,
            "columns: {load_torque: COLUMN[:UNIT]} or",
        ),
        ("  - files: j.csv\n    split: {by: runs}\n", "coulomb-viscous", 5, "with columns: {run: COLUMN}"),
        (
            "  - files: j.csv\n  - files: k.csv\n",
            "coulomb-viscous",
            6,
            "columns: {velocity: 'omega [foo]:UNIT'};",
        ),
    ],
)
def test_file_line_and_key(folder, capsys, datasets, models, line, cause):
    path = folder / "c.yaml"
    path.write_text(HEAD.format(models=models) + datasets)
    with pytest.raises(SystemExit) as ended:
        main(["run", str(path), "--out", str(folder / "out")])
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert ended.value.code == 2
    assert said.startswith(f"error: {path}:{line}: ")
    assert cause in said
    assert "--column" not in said


def test_rows_that_failed_say_it_in_keys(folder, capsys):
    """A model of a plugin is checked by its worker: the row says what is missing."""
    path = folder / "c.yaml"
    path.write_text(HEAD.format(models="all+load-friction").replace("batch", "rls") + "  - files: j.csv\n")
    with pytest.raises(InputError, match=r"columns: \{load_torque: COLUMN"):
        plan(load_config(path), folder)


def test_a_configuration_without_a_file_has_no_line(folder):
    with pytest.raises(InputError, match=r"^there is no file 'x.csv'"):
        plan(Config(datasets=[{"files": "x.csv"}]), folder)


@pytest.mark.parametrize(
    ("option", "key"),
    [
        ("--column time=t:ms --column 'torque=T [x]:N*m'", "columns: {time: 't:ms', torque: 'T [x]:N*m'}"),
        ("as in --column position=q:deg, or go", "as in columns: {position: 'q:deg'}, or go"),
        ("with --column other.j2=COLUMN:UNIT", "with columns: {other: {j2: 'COLUMN:UNIT'}}"),
        ("with --gaps drop or --gaps split", "with 'gaps: drop' or 'gaps: split'"),
        ("as in --torque-constant=-0.5", "as in 'torque_constant: -0.5'"),
        ("constant [N m/A] with --torque-constant", "constant [N m/A] with 'torque_constant'"),
        ("go on with --trust", "go on with --trust"),
    ],
)
def test_options_become_keys(option, key):
    assert as_keys(option) == key


def test_too_few_cycles_name_a_score_that_there_is():
    time = 1e-2 * np.arange(300)
    channels = {"time": time, "torque": np.sin(2.5 * time - 1.0), "velocity": np.cos(2.5 * time)}
    recording = Recording("r", Motion.ROTARY, channels, np.zeros(300, np.int64))
    with pytest.raises(InputError, match="fewer than 2 cycles of torque; use 'score: held-out'"):
        last_cycles(recording, 2)
    assert Config(datasets=[{"files": "r.csv"}], score="held-out").score == "held-out"
