"""A tournament in which no fit gave a result: exit code 1, and one line that says what to do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import main

ALL_ABSENT = "datasets: [{files: absent.csv, optional: true}]\nmodels: coulomb-viscous\nestimators: rls\n"
ALL_FAILED = "datasets: [{files: short.csv}]\nmodels: coulomb-viscous\nestimators: rls\nscore: paper\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a recording of less than one cycle."""
    monkeypatch.chdir(tmp_path)
    time = 0.002 * np.arange(400)
    velocity = np.sin(3.0 * time)
    table = np.stack([time, 0.1 * velocity + 0.2 * np.sign(velocity) + 0.1 * np.cos(3.0 * time), velocity], axis=1)
    np.savetxt("short.csv", table, delimiter=",", header="time_s,torque_Nm,velocity_rad_s", comments="")
    return tmp_path


def ended(command: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[object, list[str]]:
    capsys.readouterr()
    with pytest.raises(SystemExit) as done:
        main(command)
    return done.value.code, [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]


def test_a_run_without_any_dataset(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("bench.yaml").write_text(ALL_ABSENT, encoding="utf-8")
    code, said = ended(["run", "bench.yaml", "--out", "out", "--executor", "serial", "--report", "page.html"], capsys)
    assert (code, len(said)) == (1, 1)
    assert "bench.yaml: no fit was done" in said[0]
    assert "correct the paths" in said[0]
    assert not Path("page.html").exists()
    code, said = ended(["report", "out"], capsys)
    assert (code, len(said)) == (2, 1)
    assert "leaderboard.json: holds no fit" in said[0]


def test_a_run_of_which_every_fit_failed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("bench.yaml").write_text(ALL_FAILED, encoding="utf-8")
    code, said = ended(["run", "bench.yaml", "--out", "out", "--executor", "serial"], capsys)
    assert (code, len(said)) == (1, 1)
    assert "none of 1 fits gave a result" in said[0]
    assert "fricmodels leaderboard out --format csv" in said[0]
    assert ended(["report", "out"], capsys)[0] == 0
