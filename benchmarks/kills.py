"""Kills at random moments: what is done anew afterwards must be what would have been done without them.

``fricmodels run`` with two worker processes, and ``fricmodels improve --out``, are ended by ``kill -9`` at moments
drawn evenly over the time that they take undisturbed; the same command is given again until it comes to its end. Then
its results are compared with undisturbed ones: every number but the seconds, to the last bit. After each kill no file
may be there by halves, and no worker may live on.
Run: ``python benchmarks/kills.py [--kills 100] [--seed 0]``.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

CONFIG = """\
name: kills
datasets:
  - name: motor
    simulate:
      model: coulomb-viscous
      parameters: {K_v: 1.0e-4, K_c: 1.0e-2}
      inertia: 4.87e-6
      amplitude: 0.03
      frequency: 39.54
      noise_percent: 2
      seeds: 8
models: [coulomb-viscous, square-root]
estimators: [rls, batch]
simulate: false
"""
_PROGRAM = [sys.executable, "-m", "fricmodels"]
_ENDS = 10.0
"""Seconds after a kill within which no worker may be left."""


@dataclass
class Count:
    """What happened to one command.

    Attributes:
        kills: how often it was killed.
        ends: how often it came to its end, with results that were compared.
        states: in how many different states of its folder it was killed.
        faults: what should not have been.
    """

    kills: int = 0
    ends: int = 0
    states: set[tuple[str, ...]] = field(default_factory=set)
    faults: list[str] = field(default_factory=list)


def tournament(folder: Path) -> list[str]:
    """Write a configuration; return the command that runs it."""
    (folder / "config.yaml").write_text(CONFIG)
    return ["run", str(folder / "config.yaml"), "--jobs", "2", "--out", str(folder / "out")]


def ladder(folder: Path) -> list[str]:
    """Write a recording with an effect that its model lacks; return the command that finds it."""
    time_s = 0.004 * np.arange(2500)
    velocity = 3.0 * np.sin(2.1 * time_s) + 1.5 * np.sin(5.3 * time_s)
    slope = 6.3 * np.cos(2.1 * time_s) + 7.95 * np.cos(5.3 * time_s)
    position = -3.0 / 2.1 * np.cos(2.1 * time_s) - 1.5 / 5.3 * np.cos(5.3 * time_s)
    torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity) + 0.2 * np.sin(position)
    noisy = velocity + 0.01 * np.random.default_rng(1).standard_normal(len(time_s))
    rows = np.column_stack([time_s, torque, noisy, position])
    names = "time_s,torque_Nm,velocity_rad_s,position_rad"
    np.savetxt(folder / "arm.csv", rows, delimiter=",", header=names, comments="")
    given = ["--model", "coulomb-viscous", "--inertia", "0.05"]
    return ["improve", str(folder / "arm.csv"), *given, "--out", str(folder / "out")]


def board(out: Path) -> Any:
    """Return a leaderboard without its seconds, in an order that they do not decide."""
    rows = json.loads((out / "leaderboard.json").read_text())["rows"]
    return sorted(({**row, "seconds": None} for row in rows), key=lambda row: str(row["key"]))


def diagnosis(out: Path) -> Any:
    """Return what a ladder found."""
    return json.loads((out / "diagnosis.json").read_text())


COMMANDS: dict[str, tuple[Callable[[Path], list[str]], Callable[[Path], Any]]] = {
    "run": (tournament, board),
    "improve --out": (ladder, diagnosis),
}


def ended(command: list[str], after: float | None) -> int | None:
    """Run a command, and kill it after some seconds; return its exit code, ``None`` where it was killed."""
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "stdin": subprocess.DEVNULL}
    with subprocess.Popen([*_PROGRAM, *command], start_new_session=True, **quiet) as process:
        try:
            return process.wait(after)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            return None
        finally:
            _wait_for_workers(process.pid)


def _wait_for_workers(session: int) -> None:
    """Wait until nothing of the session of a command is left.

    Raises:
        RuntimeError: where a worker lives on; it is killed.
    """
    deadline = time.monotonic() + _ENDS
    while left := _of_session(session):
        if time.monotonic() > deadline:
            for pid in left:
                os.kill(pid, signal.SIGKILL)
            raise RuntimeError(f"{len(left)} workers live on {_ENDS:g} s after their parent was killed")
        time.sleep(0.02)


def _of_session(session: int) -> list[int]:
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if fields[0] != "Z" and int(fields[3]) == session:
            found.append(int(status.parent.name))
    return found


def faults(out: Path) -> list[str]:
    """Return what is wrong with a folder after a kill: a file that is there by halves."""
    found = []
    for path in sorted(out.glob("*.json")) if out.is_dir() else ():
        try:
            json.loads(path.read_text())
        except ValueError as error:
            found.append(f"{path.name} is there by halves: {error}")
    return found


def state(out: Path) -> tuple[str, ...]:
    """Return what tells one moment from another: the files that are there, and how many results are kept.

    Of an improvement these are the steps of its journal that are whole.
    """
    if not out.is_dir():
        return ()
    names = {path.name.partition(".part")[0] for path in out.iterdir()}
    kept = 0
    if (out / ".improve.jsonl").is_file():
        kept = (out / ".improve.jsonl").read_bytes().count(b"\n")
    if (out / "results.sqlite").is_file():
        from fricmodels.errors import FricmodelsError
        from fricmodels.tournament.store import Store

        try:
            with Store(out) as store:
                kept = len(store)
        except FricmodelsError as error:
            return (*sorted(names), str(error))
    return (*sorted(names), str(kept))


def killed(name: str, folder: Path, kills: int, seed: int) -> Count:
    """Kill a command so many times at random moments, and compare what it comes to each time that it ends."""
    make, result = COMMANDS[name]
    command, out = make(folder), folder / "out"
    begin = time.monotonic()
    if ended(command, None) != 0:
        raise RuntimeError(f"'{name}' fails undisturbed")
    if kills > 1:  # the first time compiles
        shutil.rmtree(out)
        begin = time.monotonic()
        ended(command, None)
    takes = time.monotonic() - begin
    expected = result(out)
    shutil.rmtree(out)
    rng, count = random.Random(seed), Count()
    while count.kills < kills or out.is_dir():
        code = ended(command, rng.uniform(0.1, 1.0) * takes if count.kills < kills else None)
        if code is None:
            count.kills += 1
            count.faults += faults(out)
            count.states.add(state(out))
            continue
        count.ends += 1
        if code != 0:
            count.faults.append(f"exit code {code} after {count.kills} kills")
        elif result(out) != expected:
            count.faults.append(f"other results after {count.kills} kills")
        shutil.rmtree(out, ignore_errors=True)
    return count


def main() -> int:
    """Kill every command, and print what came of it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--kills", type=int, default=100, help="of each command")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    wrong = 0
    for name in COMMANDS:
        with tempfile.TemporaryDirectory() as folder:
            count = killed(name, Path(folder), given.kills, given.seed)
        print(f"{name}: {count.kills} kills in {len(count.states)} states, {count.ends} times to the end, "
              f"{len(count.faults)} faults", flush=True)  # fmt: skip
        for fault in count.faults:
            print(f"  {fault}")
        wrong += len(count.faults)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
