"""Bad input: one line that names the cause, exit code 2, and nothing half-written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import main

HEADER = "time_s,torque_Nm,velocity_rad_s"


def motion(samples: int = 400) -> list[list[str]]:
    """Return rows of a drive that moves back and forth."""
    time = 0.01 * np.arange(samples)
    velocity = np.sin(2 * np.pi * time)
    torque = 0.1 * velocity + 0.2 * np.sign(velocity) + 0.02 * np.cos(2 * np.pi * time)
    return [[f"{value:.6f}" for value in row] for row in zip(time, torque, velocity, strict=True)]


def table(rows: list[list[str]], header: str = HEADER) -> str:
    return "\n".join([header, *(",".join(row) for row in rows)]) + "\n"


def changed(column: int, values: Callable[[int], str] | str, at: int | None = None) -> str:
    rows = motion()
    for number, row in enumerate(rows):
        if at is None or number == at:
            row[column] = values if isinstance(values, str) else values(number)
    return table(rows)


def swapped() -> str:
    rows = motion()
    rows[10], rows[11] = rows[11], rows[10]
    return table(rows)


def repeated() -> str:
    rows = motion()
    rows[11][0] = rows[10][0]
    return table(rows)


CONFIG = """\
datasets:
  - name: bench
    files: data.csv
    inertia: 0.01
models: coulomb-viscous
estimators: rls
simulate: false
"""

FILES = {
    "missing file": (None, "data.csv"),
    "empty file": ("", "data.csv"),
    "header only": (HEADER + "\n", "data.csv"),
    "missing column": (table([row[::2] for row in motion()], "time_s,velocity_rad_s"), "torque"),
    "duplicated column": (table(motion(), "time_s,torque_Nm,torque_Nm"), "torque_Nm"),
    "nan": (changed(1, "nan", at=7), "torque"),
    "infinite": (changed(2, "inf", at=7), "velocity"),
    "text in a number column": (changed(2, "fast", at=7), "fast"),
    "unsorted stamps": (swapped(), "time"),
    "repeated stamps": (repeated(), "time"),
    "one sample": (table(motion(1)), "sample"),
    "constant velocity": (changed(2, "1.5"), "velocity"),
    "standstill": (changed(2, "0"), "moves"),
    "zero torque": (changed(1, "0"), "torque"),
}

CONFIGS = {
    "negative inertia": (("inertia: 0.01", "inertia: -0.01"), ":4: ", "inertia"),
    "inertia that is no number": (("inertia: 0.01", "inertia: heavy"), ":4: ", "inertia"),
    "unknown unit": (("inertia: 0.01", "columns: {velocity: 'velocity_rad_s:wibble/s'}"), "", "wibble"),
    "unknown channel": (("inertia: 0.01", "columns: {speed: velocity_rad_s}"), "", "speed"),
    "column that is not there": (("inertia: 0.01", "columns: {velocity: qd}"), "", "qd"),
    "unknown reader": (("inertia: 0.01", "reader: cvs"), "", "did you mean 'csv'?"),
    "unknown law": (("coulomb-viscous", "colomb-viscous"), ":5: ", "did you mean 'coulomb-viscous'?"),
    "unknown effect": (("coulomb-viscous", "coulomb-viscous+cogin"), ":5: ", "did you mean 'cogging'?"),
    "unknown estimator": (("estimators: rls", "estimators: rsl"), ":6: ", "did you mean 'rls'?"),
    "unknown key": (("estimators: rls", "estimatros: rls"), ":6: ", "did you mean 'estimators'?"),
    "tag that builds objects": (("name: bench", "name: !!python/object/apply:os.getcwd []"), ":2: ", "refused"),
    "channel that is not there": (("coulomb-viscous", "coulomb-viscous+load-friction"), "", "'load_torque'"),
    "channel of temperature": (("coulomb-viscous", "coulomb-viscous+thermal"), "", "'temperature'"),
    "broken yaml": (("name: bench", "name: [bench"), ":3: ", "not valid YAML"),
    "run that is not there": (("inertia: 0.01", "runs: [7]"), "", "run '7'"),
    "impossible split": (("simulate: false", "split: {by: runs}"), "", "run"),
    "name that leaves the folder": (("datasets:", "name: ../../x\ndatasets:"), ":1: ", "no / or"),
    "name that is a path": (("datasets:", "name: /x\ndatasets:"), ":1: ", "no / or"),
    "seeds without end": (("files: data.csv", "rig: rig.yaml\n    seeds: 2000000000"), ":4: ", "seeds"),
    "number of 400 digits": (("inertia: 0.01", "inertia: " + "1" * 400), ":4: ", "…"),
    "effect twice": (("coulomb-viscous", "coulomb-viscous+cogging+cogging"), ":5: ", "twice"),
}


def refused(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    captured = capsys.readouterr()
    assert stopped.value.code == 2, captured.err
    lines = [line for line in captured.err.splitlines() if not line.startswith("warning: ")]
    assert len(lines) == 1, captured.err
    assert lines[0].startswith("error: ")
    assert "Traceback" not in captured.err
    assert captured.out == ""
    assert len(lines[0]) < 1100
    assert lines[0].isprintable()
    return lines[0]


@pytest.mark.parametrize("case", FILES)
def test_files(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, named = FILES[case]
    (tmp_path / "config.yaml").write_text(CONFIG)
    if text is not None:
        (tmp_path / "data.csv").write_text(text)
    before = sorted(tmp_path.iterdir())
    message = refused(capsys, ["run", str(tmp_path / "config.yaml"), "--out", str(tmp_path / "out")])
    assert named in message
    assert "data.csv" in message
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("case", CONFIGS)
def test_configs(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (old, new), line, named = CONFIGS[case]
    assert old in CONFIG
    config = tmp_path / "config.yaml"
    config.write_text(CONFIG.replace(old, new))
    (tmp_path / "data.csv").write_text(table(motion()))
    out = tmp_path / "out"
    out.mkdir()
    (out / "keep.txt").write_text("mine")
    message = refused(capsys, ["run", str(config), "--out", str(out)])
    assert named in message
    assert not line or f"config.yaml{line}" in message, message
    assert [file.name for file in out.iterdir()] == ["keep.txt"]


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["run"], "config"),
        (["run", "nowhere.yaml"], "nowhere.yaml"),
        (["rum"], "rum"),
        (["run", "x.yaml", "--exekutor", "local"], "--exekutor"),
        (["list", "laws", "--color"], "--color"),
        (["list", "lawz"], "lawz"),
        (["list", "datasets"], "--config"),
        (["leaderboard", "nowhere"], "nowhere"),
        (["simulate", "nowhere.yaml", "--out", "x.csv"], "nowhere.yaml"),
        (["simulate", "nowhere.yaml", "--out", "x.csv", "--seed", "-1"], "--seed"),
        (["compare", "x" * 5000 + ".csv", "--model", "coulomb-viscous"], "…"),
        (["compare", "x.csv", "--model", "\x1b[31m\u202ered"], "'\ufffd[31m\ufffdred'"),
        (["compare", "x.csv", "--model", "y" * 70_000], "unknown law"),
    ],
)
def test_arguments(
    arguments: list[str],
    named: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert named in refused(capsys, arguments)
    assert not list(tmp_path.iterdir())


def test_unknown_executor(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "config.yaml").write_text(CONFIG)
    (tmp_path / "data.csv").write_text(table(motion()))
    out = tmp_path / "out"
    arguments = ["run", str(tmp_path / "config.yaml"), "--out", str(out), "--executor", "cloud"]
    assert "cloud" in refused(capsys, arguments)
    assert not out.exists()


def test_out_that_is_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "config.yaml").write_text(CONFIG)
    (tmp_path / "data.csv").write_text(table(motion()))
    out = tmp_path / "out"
    out.write_text("mine")
    assert "out" in refused(capsys, ["run", str(tmp_path / "config.yaml"), "--out", str(out)])
    assert out.read_text() == "mine"


@pytest.mark.long
def test_wrong_units_stop_the_work_unless_trusted(tmp_path, capsys):
    path = tmp_path / "log.csv"
    rows = [[*row, f"{-np.cos(2 * np.pi * float(row[0])) * 180 / np.pi / (2 * np.pi):.6f}"] for row in motion()]
    path.write_text(table(rows, f"{HEADER},position_rad"), encoding="utf-8")
    compare = ["compare", str(path), "--model", "coulomb-viscous", "--inertia", "0.01"]
    with pytest.raises(SystemExit, match="2"):
        main(compare)
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert said[0].startswith(f"error: {path}: the velocity (velocity=velocity_rad_s) is 0.0174 times the change of")
    assert "as between deg and rad/s; give the unit, as in --column position=position_rad:deg, or go on" in said[0]
    with pytest.raises(SystemExit, match="0"):
        main([*compare, "--trust"])
    assert [line for line in capsys.readouterr().err.splitlines() if "as between deg and rad/s" in line]
    config = tmp_path / "log.yaml"
    config.write_text("name: log\ndatasets:\n  - {name: log, files: log.csv}\nmodels: coulomb-viscous\n", "utf-8")
    run = ["run", str(config), "--out", str(tmp_path / "out"), "--executor", "serial"]
    with pytest.raises(SystemExit, match="2"):
        main(run)
    assert capsys.readouterr().err.startswith("error: ")
    with pytest.raises(SystemExit, match="0"):
        main([*run, "--trust"])
    assert capsys.readouterr().err.count("as between deg and rad/s") == 1


@pytest.mark.long
def test_info_calls_no_log_usable_that_is_too_short_to_fit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "ten.csv"
    path.write_text(table(motion(400)[::40]))
    with pytest.raises(SystemExit) as done:
        main(["info", str(path)])
    assert not done.value.code
    assert "10 samples are too few to fit a model to; record 20 at least" in " ".join(capsys.readouterr().out.split())
    with pytest.raises(SystemExit, match="2"):
        main(["diagnose", str(path), "--model", "coulomb-viscous"])
    assert "10 samples are too few" in capsys.readouterr().err


def test_a_missing_channel_is_told_with_the_model_that_was_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table(motion()))
    with pytest.raises(SystemExit, match="2"):
        main(["compare", str(path), "--model", "coulomb-viscous+thermal", "--inertia", "0.02"])
    assert "'coulomb-viscous+thermal' needs the channel 'temperature'" in capsys.readouterr().err
