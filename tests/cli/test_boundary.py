"""What the system does to a command, and what leaves it: one line, no warnings, no worker left behind."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricmodels.cli import boundary, main

RIG = """\
inertia: 4.87e-6
friction: {viscous: 1.0e-4, coulomb: 1.0e-2}
effects:
  - {name: gravity, sine: 0.003}
excitation: {kind: tracking, velocity: 20, frequency: 0.5, bandwidth: 20}
sensors: {velocity_noise_percent: 0.1}
rate: 1000
samples: 8000
"""


@pytest.mark.parametrize(
    ("error", "code", "expected"),
    [
        (OSError(errno.ENOSPC, "No space left on device", "x.csv"), 2, "x.csv: no space left on device; make room"),
        (IsADirectoryError(errno.EISDIR, "Is a directory", "here"), 2, "here: is a directory"),
        (MemoryError(), 1, "not enough memory"),
        (UnicodeEncodeError("utf-8", "a\udcff", 1, 2, "surrogates not allowed"), 2, "cannot be written as UTF-8"),
        (SystemExit(0), 1, "a plugin asked the whole program to end"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (ZeroDivisionError("by\nzero"), 1, "ZeroDivisionError: by zero (unexpected;"),
    ],
)
def test_errors_are_one_line(
    error: BaseException, code: int, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert boundary.explain(error) == code
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line


def test_lines_are_bounded_and_do_not_steer_a_terminal() -> None:
    line = boundary.one_line("a\x1b[31m\u202eb \x07 " + "w" * 70_000 + " " + "many words " * 9000 + "the end")
    assert len(line) <= 1001
    assert line.isprintable()
    assert line.startswith("a\ufffd[31m\ufffdb")
    assert line.endswith("the end")
    place = boundary.one_line("d" * 5000 + "/log.csv:17: cause")
    assert place.endswith("/log.csv:17: cause")


def test_a_plugin_that_ends_the_program_is_an_error(monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    def leave(*_: Any, **__: Any) -> None:
        raise SystemExit(0)

    monkeypatch.setattr("fricmodels.cli.app", leave)
    with pytest.raises(SystemExit) as stopped:
        main(["list", "laws"])
    assert stopped.value.code == 1
    assert "a plugin asked the whole program to end" in capsys.readouterr().err


@pytest.mark.parametrize("debug", [False, True])
def test_warnings_are_for_those_who_look_for_faults(
    debug: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def warn(*_: Any, **__: Any) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            boundary.keep_warnings_from_users(debug)
            warnings.warn("mean of nothing", RuntimeWarning, stacklevel=1)

    monkeypatch.setattr("fricmodels.cli.app", warn)
    with pytest.raises(SystemExit):
        main(["--debug", "list"] if debug else ["list"])
    assert ("mean of nothing" in capsys.readouterr().err) == debug


def shell(*arguments: str, **how: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=100, **how)


@pytest.mark.long
def test_the_rig_of_the_readme_makes_no_warning(tmp_path: Path) -> None:
    """Its report divides an empty side of a reversal; warnings are errors here."""
    (tmp_path / "rig.yaml").write_text(RIG)
    data, page = str(tmp_path / "motor.csv"), str(tmp_path / "page.html")
    strict = ["-W", "error::RuntimeWarning", "-m", "fricmodels"]
    made = shell(*strict, "simulate", str(tmp_path / "rig.yaml"), "--out", data)
    assert (made.returncode, made.stderr) == (0, "")
    model = ["--model", "coulomb-viscous", "--inertia", "4.87e-6"]
    done = shell(*strict, "compare", data, *model, "--report", page)
    assert done.returncode == 0, done.stderr
    assert "Warning" not in done.stderr


@pytest.mark.skipif(os.name != "posix", reason="there are no such pipes here")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_work_is_not_lost_when_its_reader_leaves(tmp_path: Path, unbuffered: str) -> None:
    time = 2e-3 * np.arange(2000)
    velocity = 3.0 * np.sin(2.0 * time) + np.sin(5.1 * time)
    torque = 0.02 * np.gradient(velocity, time) + 0.05 * velocity + 0.3 * np.sign(velocity)
    table, data, out = np.column_stack([time, torque, velocity]), tmp_path / "log.csv", tmp_path / "out"
    np.savetxt(data, table, delimiter=",", header="time_s,torque_Nm,velocity_rad_s", comments="")
    options = ["--model", "coulomb-viscous", "--out", str(out)]
    command = [sys.executable, "-m", "fricmodels", "improve", str(data), *options]
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.wait(120) == 0
    assert (out / "diagnosis.json").exists()
    assert (out / "model.json").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
def test_a_full_disk_is_said(tmp_path: Path) -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-m", "fricmodels", "list", "laws"], stdout=full, stderr=-1, text=True)
    assert done.returncode == 2
    assert done.stderr.splitlines() == ["error: no space left on device; make room, and run it again"]


@pytest.mark.parametrize("full", [1, 2])
def test_data_and_truth_appear_together_or_not_at_all(
    full: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The disk is full at the first or the second of the two files."""
    (tmp_path / "rig.yaml").write_text(RIG.replace("8000", "800"))
    out = tmp_path / "out"
    out.mkdir()
    replace, calls = Path.replace, []

    def no_room(self: Path, target: Any) -> Path:
        calls.append(target)
        if len(calls) == full:
            raise OSError(errno.ENOSPC, "No space left on device")
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", no_room)
    with pytest.raises(SystemExit) as stopped:
        main(["simulate", str(tmp_path / "rig.yaml"), "--out", str(out / "s.csv")])
    assert stopped.value.code == 2
    assert "cannot be written: No space left on device" in capsys.readouterr().err
    assert list(out.iterdir()) == []


SPINS = """
import os, sys, time
from multiprocessing import get_context
from fricmodels.processes import end_with_parent
def spin(parent, wait):
    end_with_parent(parent)
    print(os.getpid(), flush=True)
    if wait:
        time.sleep(100)
    while True:
        pass
if __name__ == "__main__":
    context = get_context("spawn")
    for wait in (True, False):
        context.Process(target=spin, args=[os.getpid(), wait]).start()
    time.sleep(100)
"""


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are looked up in /proc")
def test_workers_end_when_their_parent_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "spins.py"
    script.write_text(SPINS)
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        workers = [int(parent.stdout.readline()) for _ in range(2)]
        assert all(map(alive, workers))
        parent.send_signal(signal.SIGKILL)
        parent.wait()
        deadline = time.monotonic() + 5
        while any(map(alive, workers)) and time.monotonic() < deadline:
            time.sleep(0.05)
        left = [pid for pid in workers if alive(pid)]
        for pid in left:
            os.kill(pid, signal.SIGKILL)
        assert left == []


def test_a_parent_that_is_gone_already_ends_its_child() -> None:
    code = f"from fricmodels.processes import end_with_parent; end_with_parent({os.getpid() + 1}); print('lives')"
    done = shell("-c", code)
    assert (done.returncode, done.stdout) == (1, "")
