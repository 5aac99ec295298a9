"""Whatever goes wrong at whichever write of a command: nothing by halves, one line, and the right exit code."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are copied by fork, and bounded by limits")

SCRIPT = Path(__file__).parent / "forked.py"
RIG = """\
inertia: 4.87e-6
friction: {viscous: 1.0e-4, coulomb: 1.0e-2}
effects:
  - {name: gravity, sine: 0.003}
excitation: {kind: tracking, velocity: 20, frequency: 0.5, bandwidth: 20}
rate: 1000
samples: 1500
"""
CONFIG = """\
name: test
datasets:
  - name: motor
    simulate:
      model: coulomb-viscous
      parameters: {K_v: 1.0e-4, K_c: 1e-2}
      inertia: 4.87e-6
      amplitude: 0.03
      frequency: 39.54
      seeds: 2
models: coulomb-viscous
estimators: rls
simulate: false
"""
ARM = ["arm.csv", "--model", "coulomb-viscous", "--inertia", "0.05"]
COMMANDS: dict[str, list[str]] = {
    "simulate, CSV": ["simulate", "rig.yaml", "--out", "out/motor.csv"],
    "simulate, Parquet": ["simulate", "rig.yaml", "--out", "out/deep/motor.parquet"],
    "simulate, a model": ["simulate", "arm.model.json", "--torque", "arm.csv", "--out", "out/motion.csv"],
    "fit": ["fit", *ARM, "--out", "out/arm.model.json"],
    "sums": ["sums", *ARM, "--out", "out"],
    "export": ["export", "arm.model.json", "--to", "c", "--out", "out/friction.h"],
    "info": ["info", "arm.csv", "--out", "out"],
    "run": ["run", "config.yaml", "--executor", "serial", "--out", "out"],
    "leaderboard, HTML": ["leaderboard", "done", "--format", "html", "--out", "out/board.html"],
    "leaderboard, Parquet": ["leaderboard", "done", "--format", "parquet", "--out", "out/board.parquet"],
    "report": ["report", "done", "--out", "out/page.html"],
    "compare": ["compare", *ARM, "--out", "out"],
    "diagnose": ["diagnose", *ARM, "--out", "out", "--report", "out/page.html"],
    "improve": ["improve", *ARM, "--out", "out"],
    "new": ["new", "effect", "rattling", "--out", "out"],
}
QUICK = ("export",)
"""What does little beside writing; the others are tried by ``make test-long``."""


def arm(path: Path) -> None:
    time_s = 0.004 * np.arange(2000)
    velocity = 3.0 * np.sin(2.1 * time_s) + 1.5 * np.sin(5.3 * time_s)
    slope = 6.3 * np.cos(2.1 * time_s) + 7.95 * np.cos(5.3 * time_s)
    torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity)
    noisy = velocity + 0.01 * np.random.default_rng(1).standard_normal(len(time_s))
    pd.DataFrame({"time_s": time_s, "torque_Nm": torque, "velocity_rad_s": noisy}).to_csv(path, index=False)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory, kept: Callable[..., Any]) -> Path:
    folder = tmp_path_factory.mktemp("bench")
    (folder / "rig.yaml").write_text(RIG)
    (folder / "config.yaml").write_text(CONFIG)
    arm(folder / "arm.csv")
    kept("coulomb-viscous").save(folder / "arm.model.json")
    return folder


def done(bench: Path) -> None:
    """Run the tournament that is exported and reported, where that has not been done."""
    if not (bench / "done").exists():
        command = ["run", "config.yaml", "--executor", "serial", "--out", "done"]
        subprocess.run([sys.executable, "-m", "fricmodels", *command], cwd=bench, check=True, capture_output=True)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.long) for name in COMMANDS]
)
def test_every_write(name: str, bench: Path, tmp_path: Path) -> None:
    command = COMMANDS[name]
    if "done" in command:
        done(bench)
    for given in bench.iterdir():
        (tmp_path / given.name).symlink_to(given)
    (tmp_path / "scratch").mkdir()
    code = [sys.executable, "-W", "ignore", str(SCRIPT), str(tmp_path / "out"), str(tmp_path / "scratch"), *command]
    ran = subprocess.run(code, cwd=tmp_path, capture_output=True, text=True, timeout=500, check=False)
    assert ran.returncode == 0, ran.stderr
    found = json.loads((tmp_path / "scratch" / "happened.json").read_text())
    assert found["code"] == 0, ran.stderr
    assert len(found["happened"]) >= 8
    print(f"{name}: {len(found['happened'])} faults")
    wrong = [f"{each}" for each in found["happened"] if not _right(each, found["after"], name)]
    assert wrong == []


def _right(each: dict[str, Any], after: dict[str, str], name: str) -> bool:
    """Whether what is there is whole, and what was said is one line."""
    shown, after = (
        {path: content for path, content in files.items() if not path.startswith("results.sqlite")}
        for files in (each["files"], after)
    )
    whole = all(after.get(path) == content for path, content in shown.items() if not _hidden(path))
    if each["fault"] == "killed":
        return whole and each["code"] == -9
    if each["code"] == 0:  # a folder that is there already, or nothing left to write
        return shown == after and "error" not in each["said"]
    lines = [line for line in each["said"].splitlines() if line.startswith("error: ")]
    one_line = len(lines) == 1 and each["code"] in (1, 2) and "unexpected" not in each["said"]
    tidy = not any(_hidden(path) or ".part" in path or ".tmp" in path for path in shown)
    together = name.startswith("run") or len(shown) in (0, len(after)) or "simulate" not in name
    return whole and one_line and tidy and together and "Traceback" not in each["said"]


def _hidden(path: str) -> bool:
    return any(part.startswith(".") for part in Path(path).parts)
