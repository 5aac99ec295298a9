"""Mistakes of every day on the command line: the line says what is meant, and what to write instead."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import fricmodels
from fricmodels.cli import main
from fricmodels.cli.sums import said_of
from fricmodels.compensation.present import motions_of
from fricmodels.diagnosis.document import document
from fricmodels.errors import InputError


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    room = tmp_path_factory.mktemp("way-out")
    time = 2e-3 * np.arange(4000)
    velocity = 2.0 * np.sin(3.0 * time) + np.sin(7.0 * time)
    position = -2.0 / 3.0 * np.cos(3.0 * time) - np.cos(7.0 * time) / 7.0
    torque = 1.8 * np.gradient(velocity, 2e-3) + 6.0 * velocity + 8.0 * np.sign(velocity) + np.sin(5.0 * position)
    rows = np.column_stack([time, torque, velocity, position])
    header = "time_s,torque_Nm,velocity_rad_s,position_rad"
    np.savetxt(room / "joint.csv", rows, delimiter=",", header=header, comments="")
    return room


def call(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as ended:
        main([str(argument) for argument in arguments])
    said = capsys.readouterr()
    return int(ended.value.code or 0), said.out, said.err


@pytest.mark.parametrize(
    ("written", "way_out"),
    [
        ("5 g cm^2", "give --inertia 5e-07"),
        ("5 kg*cm^2", "give --inertia 0.0005"),
        ("1,8", "give --inertia 1.8"),
        ("much", "give it as in --inertia 0.02"),
        ("3 N", "give it as in --inertia 0.02"),
    ],
)
def test_an_inertia_that_is_no_number(room, capsys, written, way_out):
    for command in (["info"], ["compare", "--model", "coulomb-viscous"]):
        code, _, err = call(capsys, *command, room / "joint.csv", "--inertia", written)
        assert code == 2
        assert err.count("\n") == 1
        assert f"'{written}' is no number; the inertia is one of kg m²" in err
        assert way_out in err


@pytest.mark.parametrize(
    ("arguments", "cause"),
    [
        (["list", "laws", "--config", "x.yaml"], "--config goes with 'list datasets'"),
        (["export", "x.model.json", "--to", "c", "--armature", "3"], "--armature is written into an MJCF"),
        (["compare", "{data}", "{data}", "--model", "coulomb-viscous"], "is named twice"),
        (["check", "nonexist"], "'fricmodels list'"),
    ],
)
def test_what_would_be_ignored_is_refused(room, capsys, arguments, cause):
    code, _, err = call(capsys, *(argument.format(data=room / "joint.csv") for argument in arguments))
    assert code == 2
    assert cause in err
    assert len(err) < 200 + len(str(room)) * 2


@pytest.mark.parametrize(
    ("key", "line"),
    [("files: [joint.csv, joint.csv]\nmodels: coulomb-viscous", 3), ("files: joint.csv\nmodels: [a, a]", 4)],
)
def test_what_stands_twice_in_a_tournament(room, capsys, key, line):
    path = room / "twice.yaml"
    path.write_text(f"name: t\ndatasets:\n  - {key}\nestimators: batch\n")
    code, _, err = call(capsys, "run", path, "--out", room / "out")
    assert code == 2
    assert f"{path}:{line}: " in err
    assert "stands twice; leave one out" in err


def test_the_report_of_a_run_that_was_stopped(tmp_path, capsys):
    (tmp_path / "results.sqlite").write_bytes(b"")
    code, _, err = call(capsys, "report", tmp_path)
    assert code == 2
    assert "the run was stopped before its leaderboard was written" in err
    assert f"fricmodels leaderboard {tmp_path}" in err


@pytest.mark.parametrize("work", [fricmodels.compare, fricmodels.diagnose, fricmodels.improve])
def test_a_file_is_no_recording(work):
    with pytest.raises(InputError, match=r"read the file first: fricmodels.read\('elbow.csv'\)"):
        work("elbow.csv", "coulomb-viscous")


def test_numbers_that_are_none(room):
    recording = fricmodels.read(room / "joint.csv")
    with pytest.raises(InputError, match=r"inertia must be positive and finite, got '1\.8'"):
        fricmodels.compare(recording, "coulomb-viscous", "1.8")
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous", 1.8))
    torque = np.ones(20)
    torque[7] = np.nan
    with pytest.raises(InputError, match="the torque is no finite number at sample 8"):
        model.simulate(torque, interval=1e-3)
    with pytest.raises(InputError, match="the motor torque is no finite number"):
        model.step(model.start(), float("nan"), 1e-3)
    with pytest.raises(InputError, match=r"^what is given \(int\) cannot be kept"):
        fricmodels.keep(3)


def test_what_is_found_is_one_of_the_candidates(room):
    """What is found beside a law that keeps its bounds was not tested beside the given one, and not in the table."""
    recording = fricmodels.read(room / "joint.csv")
    diagnosis = fricmodels.diagnose(recording, "coulomb-viscous", 1.8)
    name = diagnosis.findings[0].tested.name
    others = tuple(tested for tested in diagnosis.result.tested if tested.name != name)
    data = document(replace(diagnosis, result=replace(diagnosis.result, tested=others), passing=()))
    assert [row.name for row in data.candidates].count(name) == 1
    assert next(row for row in data.candidates if row.name == name).gates


@pytest.mark.parametrize(("command", "says"), [("compare", "overlay.csv"), ("info", "is an error here too")])
def test_help_says_what_is_so(capsys, command, says):
    code, out, _ = call(capsys, command, "--help")
    assert code == 0
    assert says in " ".join(out.split())


def test_one_is_no_plural():
    assert said_of(SimpleNamespace(samples=9, files=[1])) == "9 samples in 1 file"
    assert said_of(SimpleNamespace(samples=9, files=[1, 2])) == "9 samples in 2 files"
    assert motions_of(SimpleNamespace(experiments=[1])) == "1 motion"
    assert motions_of(SimpleNamespace(experiments=[1, 2])) == "2 motions"
