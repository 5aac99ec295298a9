"""The commands: quick to start, thin, and with the exit codes that they promise."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fricmodels
from fricmodels import cli, plugins
from fricmodels.cli import COMMANDS, main
from fricmodels.recording import Recording
from fricmodels.tournament.leaderboard import Leaderboard

HEAVY = ("casadi", "pandas", "scipy", "llvmlite", "numba", "numpy", "pint", "pyarrow", "filterpy")


def call(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    captured = capsys.readouterr()
    return int(stopped.value.code or 0), captured.out, captured.err


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], *[[name, "--help"] for name in COMMANDS]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    program = (
        "import sys\n"
        "from fricmodels.cli import main\n"
        "try:\n    main(sys.argv[1:])\n"
        f"finally:\n    print([n for n in {HEAVY!r} if n in sys.modules], file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    assert done.stdout


def test_a_fit_imports_no_library_that_takes_long_and_that_it_does_not_need() -> None:
    """Each of them takes half a second: so much longer were every process of a tournament."""
    program = """
import sys
import numpy as np
from estimators.batch import Batch
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
rng, time = np.random.default_rng(0), 0.002 * np.arange(4000)
velocity = np.sin(5 * time) + np.sin(8.3 * time) + 0.02 * rng.standard_normal(4000)
torque = 5 * np.cos(5 * time) + 8.3 * np.cos(8.3 * time) + np.sign(velocity)
recording = Recording("x", Motion.ROTARY, {"time": time, "torque": torque, "velocity": velocity}, np.zeros(4000, int))
Batch({}).fit(Drive(Model.parse("coulomb-viscous")), recording)
print([name for name in ("pandas", "scipy.signal", "scipy.stats") if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_help_is_quick() -> None:
    """The processor time of the best of some tries: other work on the machine does not count."""
    best = min(seconds_of([sys.executable, "-m", "fricmodels", "--help"]) for _ in range(3))
    assert best < 0.4


def seconds_of(command: list[str]) -> float:
    if not hasattr(os, "wait4"):
        begin = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        return time.perf_counter() - begin
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    return usage.ru_utime + usage.ru_stime


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(capsys, "--version") == (0, f"fricmodels {fricmodels.__version__}\n", "")


def test_no_command_shows_help(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = call(capsys)
    assert (code, err) == (0, "")
    assert "leaderboard" in out


def test_list_shows_equations_units_and_origin(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "300")  # narrow tables fold their cells
    code, out, _ = call(capsys, "list", "laws")
    assert code == 0
    text = " ".join(out.split())
    for name in plugins.load().laws:
        assert name in text
    assert "K_v·ω + K_c·sgn ω" in text
    assert "K_v [N m s/rad]" in text
    assert "fricmodels" in text
    assert "K_v [N s/m]" in " ".join(call(capsys, "list", "laws", "--linear")[1].split())


@pytest.mark.parametrize("kind", ["effects", "estimators", "readers"])
def test_list_shows_all_that_is_registered(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = call(capsys, "list", kind)
    assert (code, err) == (0, "")
    for name in getattr(plugins.load(), kind):
        assert name in out


def test_schema_is_json_schema_of_the_configuration(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = call(capsys, "schema")
    schema = json.loads(out)
    assert code == 0
    assert schema["additionalProperties"] is False
    assert {"datasets", "models", "estimators", "rank_by"} <= set(schema["properties"])


@pytest.mark.parametrize(("kind", "key"), [("diagnosis", "verdict"), ("leaderboard", "rows")])
def test_schema_of_a_file_of_results(kind: str, key: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = call(capsys, "schema", kind)
    properties = json.loads(out)["properties"]
    assert code == 0
    assert properties["schema"]["const"] == f"fricmodels/{kind}/1"
    assert properties[key]["description"]


def test_a_schema_that_is_unknown_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = call(capsys, "schema", "nonsense")
    assert code == 2
    assert len(err.splitlines()) == 1


def test_an_unexpected_error_is_one_line(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def fails() -> None:
        raise RuntimeError("what\nnow")

    monkeypatch.setattr(plugins, "load", fails)
    code, _, err = call(capsys, "list", "laws")
    assert code == 1
    assert err.splitlines() == [
        "error: RuntimeError: what now (unexpected; 'fricmodels --debug …' shows the traceback)"
    ]
    assert "Traceback" in call(capsys, "--debug", "list", "laws")[2]


def test_an_interruption_is_no_traceback(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def stops() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(plugins, "load", stops)
    assert call(capsys, "list", "laws")[0] == 130


@pytest.mark.parametrize("form", ["table", "md", "csv", "json", "html", "latex", "parquet"])
def test_leaderboard_in_every_format(form: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    row = {
        "model": "coulomb-viscous", "estimator": "batch", "dataset": "[bold]motor[/bold]", "tags": {"seed": 1},
        "rms_torque_error_percent": 1.5, "held_out_rms_torque_error_percent": 1.75, "parameters": {"K_v": 1e-4},
        "standard_errors": {"K_v": 1e-6}, "true_parameters": None, "seconds": 0.1, "status": "ok", "message": "",
    }  # fmt: skip
    Leaderboard.ranked([row]).write(tmp_path)
    target = tmp_path / f"board.{form}"
    with pytest.raises(SystemExit) as stopped:
        main(["leaderboard", str(tmp_path), "--format", form, "--out", str(target)])
    assert stopped.value.code == 0
    assert target.stat().st_size > 0
    if form == "parquet":
        return
    assert "coulomb" in target.read_text()
    with pytest.raises(SystemExit):
        main(["leaderboard", str(tmp_path), "--format", form])
    out, err = capfd.readouterr()
    assert "1.75" in out
    assert err == ""
    if form == "table":
        assert "[bold]motor[/bold]" in out


def test_a_command_is_one_line_and_one_module() -> None:
    folder = Path(cli.__file__).parent
    modules = {file.stem for file in folder.glob("*.py")}
    assert set(COMMANDS) <= modules


@pytest.mark.long
def test_several_files_are_one_recording_and_further_channels_are_mapped(
    tmp_path: Path, made: Callable[..., Recording], capsys: pytest.CaptureFixture[str]
) -> None:
    recording = made(samples=4000)
    pull = np.sin(3.1 * recording.time)
    columns = ["time_s", "torque_Nm", "velocity_rad_s", "position_rad", "ddq2"]
    values = [recording.time, recording.torque + pull, recording.velocity, recording["position"], np.degrees(pull)]
    table = np.column_stack(values)
    for name, rows in (("a", slice(0, 2000)), ("b", slice(2000, 4000))):
        np.savetxt(tmp_path / f"{name}.csv", table[rows], delimiter=",", header=",".join(columns), comments="")
    files = [str(tmp_path / "a.csv"), str(tmp_path / "b.csv")]
    given = [*files, "--model", "coulomb-viscous", "--inertia", "2", "--column", "other.j2_acceleration=ddq2:deg/s^2"]
    code, out, _ = call(capsys, "diagnose", *given, "--out", str(tmp_path / "found"))
    assert code == 0
    assert "acceleration of joint 2" in " ".join(out.split())
    found = json.loads((tmp_path / "found" / "diagnosis.json").read_text())
    assert found["effects"][0]["name"] == "other(j2_acceleration)"
    assert found["effects"][0]["units"] == {"c": "kg m^2"}
    assert found["effects"][0]["parameters"]["c"] == pytest.approx(1, abs=0.01)
    assert found["recording"]["files"] == files
    code, out, _ = call(capsys, "report", str(tmp_path / "found"))
    assert code == 0
    page = (tmp_path / "found" / "report.html").read_text()
    assert "b.csv --model coulomb-viscous" in page
