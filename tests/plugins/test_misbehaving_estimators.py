"""Estimators that die, hang, raise or give nonsense become rows with their reason; the rest goes on."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fricmodels.tournament import load_config, run
from fricmodels.tournament.store import Store

Install = Callable[[str, str], Path]

ESTIMATORS = '''\
"""Estimators that misbehave, and one that does not."""

import os
import time
import warnings

import numpy as np

from fricmodels import Estimator, Solution, hookimpl
from fricmodels.errors import EstimationError
from fricmodels.fit import Status


class Known(Estimator):
    name = "known"
    wait = 0.0

    def solve(self, drive, recording, seed):
        time.sleep(self.wait)
        values = {key: 0.01 for key in drive.keys}
        values[drive.inertia_key] = drive.inertia
        return Solution(self.change(values), np.zeros((len(drive.keys), len(drive.keys))))

    def change(self, values):
        return values


class Slow(Known):
    name = "slow"
    wait = 0.4


class Dies(Known):
    name = "dies"

    def change(self, values):
        os._exit(3)


class Hangs(Known):
    name = "hangs"

    def change(self, values):
        while True:
            time.sleep(0.01)


class Raises(Known):
    name = "raises"

    def change(self, values):
        return values["nothing"]


class Refuses(Known):
    name = "refuses"

    def change(self, values):
        raise EstimationError("there is no plateau")


class Nonsense(Known):
    name = "nonsense"

    def change(self, values):
        return {**values, "K_v": float("nan")}


class Warns(Known):
    name = "warns"

    def change(self, values):
        warnings.warn("thin ice", stacklevel=1)
        return values


@hookimpl
def fricmodels_estimators():
    return [Known, Slow, Dies, Hangs, Raises, Refuses, Nonsense, Warns]
'''

CONFIG = """\
datasets:
  - name: motor
    simulate: {{model: coulomb-viscous, parameters: {{K_v: 1.0e-4, K_c: 0.01}}, inertia: 4.87e-6, amplitude: 0.02,
               frequency: 39.54, noise_percent: 2, seeds: {seeds}}}
models: coulomb-viscous
estimators: [{estimators}]
simulate: false
timeout: {timeout}
"""


def configured(tmp_path: Path, estimators: str, seeds: int = 1, timeout: float = 60) -> Path:
    file = tmp_path / "config.yaml"
    file.write_text(CONFIG.format(estimators=estimators, seeds=seeds, timeout=timeout))
    return file


@pytest.mark.long
def test_each_becomes_a_row_with_its_reason(install: Install, tmp_path: Path) -> None:
    install("misbehaving", ESTIMATORS)
    file = configured(tmp_path, "dies, hangs, raises, refuses, nonsense, known, warns", timeout=6)
    board = run(load_config(file), tmp_path / "out", processes=2)
    found = {row["estimator"]: (row["status"], row["message"]) for row in board.rows}
    assert found["known"] == ("ok", "")
    assert found["dies"] == ("crashed", "its process died with exit code 3")
    assert found["hangs"] == ("timeout", "took longer than 6 s")
    assert found["raises"] == ("failed", "KeyError: 'nothing'")
    assert found["refuses"] == ("failed", "there is no plateau")
    assert found["nonsense"][0] == "diverged"
    assert found["warns"] == ("ok", "warned: thin ice")
    assert len(board.rows) == 7
    assert [row["status"] for row in board.rows[:2]] == ["ok"] * 2
    assert all(row["status"] != "ok" for row in board.rows[2:])
    assert all(row["true_parameters"] == {"J": 4.87e-6, "K_v": 1e-4, "K_c": 0.01} for row in board.rows)


def test_running_again_does_only_what_is_missing(install: Install, tmp_path: Path) -> None:
    install("misbehaving", ESTIMATORS)
    done: list[str] = []

    def report(count: int, total: int, job: object, row: dict[str, object]) -> None:
        done.append(f"{row['estimator']} {row['tags']}")

    out = tmp_path / "out"
    first = run(load_config(configured(tmp_path, "known")), out, executor="serial", report=report)
    assert len(done) == 1
    again = run(load_config(configured(tmp_path, "known")), out, executor="serial", report=report)
    assert len(done) == 1
    assert again == first
    run(load_config(configured(tmp_path, "known, refuses", seeds=2)), out, executor="serial", report=report)
    assert len(done) == 1 + 3
    run(load_config(configured(tmp_path, "known, refuses", seeds=2)), out, executor="serial", report=report, retry=True)
    assert len(done) == 4 + 2
    assert all("refuses" in line for line in done[-2:])


def test_other_settings_are_another_result(install: Install, tmp_path: Path) -> None:
    install("misbehaving", ESTIMATORS)
    out = tmp_path / "out"
    run(load_config(configured(tmp_path, "known")), out, executor="serial")
    text = configured(tmp_path, "known").read_text()
    for old, new in (("0.02,", "0.021,"), ("noise_percent: 2", "noise_percent: 3"), ("4.87e-6", "4.88e-6")):
        assert old in text
        (tmp_path / "other.yaml").write_text(text.replace(old, new))
        with Store(out) as store:
            before = len(store)
        run(load_config(tmp_path / "other.yaml"), out, executor="serial")
        with Store(out) as store:
            assert len(store) == before + 1


@pytest.mark.long
def test_serial_and_local_agree(install: Install, tmp_path: Path) -> None:
    install("misbehaving", ESTIMATORS)
    config = load_config(configured(tmp_path, "known", seeds=3))
    boards = [run(config, tmp_path / name, executor=name, processes=2) for name in ("serial", "local")]
    rows = [[{**row, "seconds": None} for row in board.rows] for board in boards]
    assert rows[0] == rows[1]


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.long
def test_an_interruption_loses_nothing(install: Install, tmp_path: Path) -> None:
    site = install("misbehaving", ESTIMATORS)
    file = configured(tmp_path, "slow", seeds=40)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "fricmodels", "run", str(file), "--out", str(out), "--jobs", "1"]
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "PYTHONPATH": paths}
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        start_new_session=True,
        # Whoever runs the tests in the background may have told their children to ignore interruptions.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and process.poll() is None and finished(out) < 3:
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 130
    assert len(errors.splitlines()) == 1, errors
    assert "the same command goes on from there" in errors
    kept = finished(out)
    assert 3 <= kept < 40
    assert not (out / "leaderboard.json").exists()
    file.write_text(CONFIG.format(estimators="slow", seeds=kept + 1, timeout=60))
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr
    rows = json.loads((out / "leaderboard.json").read_text())["rows"]
    assert [row["status"] for row in rows] == ["ok"] * (kept + 1)


def finished(out: Path) -> int:
    """Return how many rows are in the store of a run that goes on."""
    if not (out / "results.sqlite").is_file():
        return 0
    connection = sqlite3.connect(out / "results.sqlite", timeout=10)
    try:
        return int(connection.execute("SELECT COUNT(*) FROM results").fetchone()[0])
    except sqlite3.OperationalError:
        return 0
    finally:
        connection.close()
