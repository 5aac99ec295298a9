"""Five names do the whole loop, and cost nothing until they are used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import fricmodels
from fricmodels.rig import write
from fricmodels.rig.demonstration import hidden

LOOP = """
from fricmodels import read, compare, diagnose, improve, run

recording = read("joint.csv")
assert compare(recording, "coulomb-viscous", inertia=1.8).errors.held_out_percent > 5
assert diagnose(recording, "coulomb-viscous", inertia=1.8).verdict == "missing-effect"
ladder = improve(recording, "coulomb-viscous", inertia=1.8)
assert ladder.rungs[-1].comparison.errors.bands[2].held_out_percent < 1
"""
TOURNAMENT = """
name: joint
datasets:
  - {name: joint, files: joint.csv, inertia: 1.8}
models: coulomb-viscous
estimators: rls
simulate: false
"""


def python(script: str, where: Path) -> subprocess.CompletedProcess[str]:
    (where / "script.py").write_text(script, encoding="utf-8")
    return subprocess.run([sys.executable, "script.py"], cwd=where, capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("loop")
    write(hidden().model_copy(update={"samples": 7_500}).simulate(), folder / "joint.csv")
    (folder / "joint.yaml").write_text(TOURNAMENT, encoding="utf-8")
    return folder


def test_importing_the_package_imports_nothing_heavy(tmp_path: Path) -> None:
    heavy = "casadi numpy scipy llvmlite numba pandas rich pydantic plotly IPython"
    done = python(f"import sys, fricmodels\nprint(sorted(set({heavy.split()}) & set(sys.modules)))", tmp_path)
    assert done.stdout.strip() == "[]", done.stderr


def test_every_name_is_there_and_listed() -> None:
    for name in fricmodels.__all__:
        assert name == "hookimpl" or getattr(fricmodels, name).__name__ == name
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = fricmodels.nothing


@pytest.mark.long
def test_the_loop_in_a_script(folder: Path) -> None:
    done = python(LOOP, folder)
    assert done.returncode == 0, done.stderr


def test_a_tournament_is_run_from_its_file_from_anywhere(folder: Path, tmp_path: Path) -> None:
    board = fricmodels.run(folder / "joint.yaml", tmp_path / "run", executor="serial")
    assert [row["status"] for row in board.rows] == ["ok"]
    again = fricmodels.run(str(folder / "joint.yaml"), tmp_path / "run", executor="serial")
    assert again == board


@pytest.mark.long
def test_a_script_without_the_guard_is_told_of_it(folder: Path) -> None:
    done = python('from fricmodels import run\nrun("joint.yaml", "unguarded")', folder)
    assert "put run(…) under if __name__ == '__main__'" in done.stderr


@pytest.mark.long
def test_a_script_with_the_guard_runs(folder: Path) -> None:
    guarded = python('from fricmodels import run\nif __name__ == "__main__":\n    run("joint.yaml", "guarded")', folder)
    assert guarded.returncode == 0, guarded.stderr
