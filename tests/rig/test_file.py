"""Rig files, what is written, and the command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels.cli import main
from fricmodels.errors import InputError
from fricmodels.rig import load_rig, write

RIGS = sorted((Path(__file__).parents[2] / "configs" / "rigs").glob("*.yaml"))
GOOD = """\
inertia: 1.5
friction:
  viscous: 4.0
  coulomb: 10.0
effects:
  - name: cogging
    harmonics:
      - order: 7
        amplitude: 1.0
excitation:
  kind: sine
  amplitude: 30.0
  frequency: 1.0
rate: 500
samples: 400
"""


def saved(folder, text):
    path = folder / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("path", RIGS, ids=[path.stem for path in RIGS])
def test_every_rig_that_comes_with_the_project_moves(path):
    rig = load_rig(path)
    recording = rig.simulate()
    assert rig.name == path.stem
    speed = np.concatenate([history.velocity for history in rig.histories])
    assert min(np.mean(speed > 0), np.mean(speed < 0)) > 0.2
    assert all(np.all(np.isfinite(values)) for values in recording.channels.values())
    assert [effect["name"] for effect in recording.provenance["hidden_effects"]] == [e.name for e in rig.effects]


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("inertia: 1.5", "inertia: -1.5", 1, "'inertia': input should be greater than 0, got -1.5"),
        ("inertia: 1.5", "inertai: 1.5", 1, "'inertai'"),
        ("  coulomb", "  coulom", 4, "'coulom' in 'friction' is unknown; did you mean 'coulomb'"),
        ("name: cogging", "name: coging", 6, "key 'name' in 'effects' cannot be 'coging'; did you mean 'cogging'"),
        ("        amplitude", "        amplitde", 9, "did you mean 'amplitude'"),
        ("kind: sine", "kind: sinus", 11, "did you mean 'sine'"),
        ("  frequency", "  frequncy", 13, "did you mean 'frequency'"),
        ("rate: 500", "rate: fast", 14, "'rate': input should be a valid number"),
        ("rate: 500", "rate: .nan", 14, "'rate'"),
        ("order: 7", "phase: 7", 8, "give either 'order' or 'period'"),
        ("rate: 500\n", "", 1, "'rate' is missing"),
        ("rate: 500", "rate: 500\nrate: 400", 15, "key 'rate' stands twice; it is already on line 14"),
        ("rate: 500", "rate: [500", 15, "not valid YAML"),
        ("rate: 500", "rate: !!python/object:os.system {}", 14, "refused: a configuration builds no objects"),
    ],
)
def test_a_wrong_file_is_refused_by_line_and_key(tmp_path, old, new, line, words):
    path = saved(tmp_path, GOOD.replace(old, new))
    with pytest.raises(InputError) as error:
        load_rig(path)
    assert words in str(error.value)
    assert str(error.value).startswith(f"{path}:{line}:")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("text", "words"), [("", "empty"), ("- 1\n", "mapping"), ("just words\n", "mapping")])
def test_a_file_that_is_no_mapping_is_refused(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        load_rig(saved(tmp_path, text))


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"none\.yaml: there is no such file"):
        load_rig(tmp_path / "none.yaml")


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_the_data_and_its_truth_are_written_apart(tmp_path, suffix):
    recording = load_rig(saved(tmp_path, GOOD)).simulate()
    data, truth = write(recording, tmp_path / f"data{suffix}")
    table = pd.read_csv(data) if suffix == ".csv" else pd.read_parquet(data)
    assert list(table.columns) == ["time_s", "torque_Nm", "velocity_rad_s", "position_rad"]
    np.testing.assert_allclose(table["velocity_rad_s"], recording.velocity, rtol=1e-12)
    known = json.loads(truth.read_text())
    assert known["true_model"] == "coulomb-viscous+cogging"
    assert known["true_parameters"] == {"J": 1.5, "K_v": 4.0, "K_c": 10.0}
    assert known["hidden_effects"][0]["parameters"]["harmonics"][0]["k"] == 7.0
    assert {path.name for path in tmp_path.iterdir()} == {"rig.yaml", data.name, truth.name}


def test_another_format_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"\.csv or \.parquet"):
        write(load_rig(saved(tmp_path, GOOD)).simulate(), tmp_path / "data.txt")


def test_the_command_writes_both_files(tmp_path, capsys):
    path = saved(tmp_path, GOOD)
    with pytest.raises(SystemExit) as end:
        main(["simulate", str(path), "--out", str(tmp_path / "out" / "data.csv"), "--seed", "3"])
    assert end.value.code == 0
    assert (tmp_path / "out" / "data.csv").exists()
    assert json.loads((tmp_path / "out" / "data.truth.json").read_text())["rig"]["seed"] == 3
    assert "400 samples" in capsys.readouterr().out


def test_the_command_refuses_a_wrong_file_with_one_line(tmp_path, capsys):
    path = saved(tmp_path, GOOD.replace("viscous", "viscos"))
    with pytest.raises(SystemExit) as end:
        main(["simulate", str(path), "--out", str(tmp_path / "data.csv")])
    assert end.value.code == 2
    assert "viscos" in capsys.readouterr().err
    assert not (tmp_path / "data.csv").exists()
