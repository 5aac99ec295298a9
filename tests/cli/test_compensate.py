"""``compensate`` from rig files to figures, and what it says to wrong input."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from fricmodels.cli import main

RIG = """
inertia: 1.0
friction: {viscous: 1.0, coulomb: 8.0}
effects:
  - {name: cogging, harmonics: [{order: 9.0, amplitude: 2.0, phase: 0.4}]}
excitation: {kind: tracking, velocity: 1.5, frequency: 0.5, lines: 3, bandwidth: 8.0}
sensors: {velocity_noise_percent: 0.5}
rate: 500
samples: 6000
"""


def call(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as stopped:
        main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return int(stopped.value.code or 0), captured.out, captured.err


@pytest.fixture
def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "joint.yaml").write_text(RIG, encoding="utf-8")
    return tmp_path / "joint.yaml"


@pytest.mark.long
def test_from_a_rig_to_figures(rig: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The hidden effect is found, and what it is worth is printed: the answer, how sure, what next."""
    out = tmp_path / "new" / "worth.json"
    code, text, err = call(capsys, "compensate", "joint.yaml", "--motions", 2, "--motion", "trapezoid", "--out", out)
    assert code == 0, err
    lines = text.splitlines()
    assert lines[0].startswith("joint: compensated by coulomb-viscous+cogging, ")
    assert all(len(line) <= 80 for line in lines if "fricmodels" not in line and "wrote" not in line)
    assert text.index("no compensation") < text.index("How sure") < text.index("Next:")
    data = json.loads(out.read_text(encoding="utf-8"))
    assert data["schema"] == "fricmodels/compensation/1"
    (found,) = data["rigs"]
    assert (found["named"], found["true_model"]) == (["cogging"], "coulomb-viscous+cogging")
    ways = {way["way"]: way for way in found["ways"]}
    assert [*ways] == ["none", "coulomb-viscous", "improved", "true"]
    assert ways["none"]["percent_of_none"] == 100.0
    assert ways["improved"]["percent_of_none"] < 0.2 * ways["coulomb-viscous"]["percent_of_none"] < 10.0
    assert ways["true"]["percent_of_none"] < 1.0
    assert not any(way["limit_cycle"] for way in found["ways"])
    assert len(ways["improved"]["each"]) == len(found["motions"]) == 2

    # The command that it names next makes a file, which it takes in turn.
    commands = [line.split() for line in lines if line.startswith("  fricmodels ")]
    assert [command[1] for command in commands] == ["simulate", "fit", "export"]
    for command in commands:
        code, _, err = call(capsys, *command[1:])
        assert code == 0, err
    again = tmp_path / "again.csv"
    code, text, err = call(
        capsys, "compensate", "joint.yaml", "joint.yaml", "--model", "joint.model.json", "--motions", 1,
        "--motion", "trapezoid", "--out", again,
    )  # fmt: skip
    assert code == 0, err
    assert text.startswith("2 drives: in the median the model leaves ")
    rows = list(csv.DictReader(again.read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 8
    assert rows[2]["way"] == "joint.model.json"
    assert float(rows[2]["percent_of_none"]) < 1.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["missing.yaml"], "no such file"),
        (["joint.yaml", "--out", "worth.txt"], ".json or .csv"),
        (["joint.yaml", "--model", "coulomb-viscos"], "coulomb-viscous"),
        (["joint.yaml", "--model", "missing.model.json"], "no such file"),
        (["joint.yaml", "--model", "coulomb-viscous", "--model", "a.json"], "not both"),
        (["joint.yaml", "--at", "nowhere"], "--at"),
        (["joint.yaml", "--rate", "0"], "--rate"),
        (["joint.yaml", "--delay", "-1"], "--delay"),
        (["joint.yaml", "--encoder-step", "nan"], "--encoder-step"),
        (["joint.yaml", "--motions", "0"], "--motions"),
        ([], "RIG"),
    ],
)
def test_wrong_input_is_one_line(
    rig: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    code, out, err = call(capsys, "compensate", *arguments)
    assert code == 2
    assert out == ""
    assert words in err
    assert len(err.strip().splitlines()) == 1


def test_a_drive_that_does_not_move_says_so(rig: Path, capsys: pytest.CaptureFixture[str]) -> None:
    still = RIG.replace("kind: tracking, velocity: 1.5, frequency: 0.5, lines: 3, bandwidth: 8.0", "kind: sine, "
                        "amplitude: 1.0, frequency: 0.5").replace("amplitude: 2.0", "amplitude: 0.01")  # fmt: skip
    rig.write_text(still, encoding="utf-8")
    code, _, err = call(capsys, "compensate", rig)
    assert code == 2
    assert "does not move" in err
    assert len(err.strip().splitlines()) == 1
