"""No command writes over a file that it reads: exit code 2, one line that names it, and nothing changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import main
from fricmodels.cli.outputs import check_outputs
from fricmodels.errors import InputError


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a recording, a link to it, a model's file, sums, a rig, a tournament, and a run."""
    folder = tmp_path_factory.mktemp("outputs")
    time = 0.005 * np.arange(2000)
    angle = np.outer(time, [2.1, 5.3, 9.7])
    velocity, slope = np.sin(angle) @ [3.0, 2.0, 1.0], np.cos(angle) @ [6.3, 10.6, 9.7]
    torque = 0.05 * slope + 0.1 * velocity + 0.6 * np.sign(velocity)
    table = np.stack([time, torque, velocity], axis=1)
    data = folder / "data.csv"
    np.savetxt(data, table, delimiter=",", header="time_s,torque_Nm,velocity_rad_s", comments="")
    (folder / "link.csv").symlink_to("data.csv")
    for command, out in (("fit", "model.json"), ("sums", "data.sums.json")):
        with pytest.raises(SystemExit) as done:
            main([command, str(data), "--model", "coulomb-viscous", "--inertia", "0.05", "--out", str(folder / out)])
        assert done.value.code == 0
    tournament = "datasets: [{files: data.csv, inertia: 0.05}]\nmodels: coulomb-viscous\nestimators: rls\n"
    for name, text in {"rig.yaml": "inertia: 1.0\n", "bench.yaml": tournament}.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "info.json").write_text("{}", encoding="utf-8")
    (folder / "done").mkdir()
    for name in ("leaderboard.json", "results.sqlite"):
        (folder / "done" / name).write_text("{}", encoding="utf-8")
    return folder


@pytest.fixture
def folder(made: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return that folder, and go there."""
    monkeypatch.chdir(made)
    return made


MODEL = ["--model", "coulomb-viscous", "--inertia", "0.05"]
COMMANDS = [
    ["fit", "data.csv", *MODEL, "--out", "data.csv"],
    ["fit", "data.csv", *MODEL, "--out", "link.csv"],
    ["fit", "link.csv", *MODEL, "--out", "data.csv"],
    ["fit", "data.csv", "--model", "model.json", "--out", "model.json"],
    ["fit", "data.sums.json", "--model", "coulomb-viscous", "--out", "data.sums.json"],
    ["report", "data.csv", "--inertia", "0.05", "--out", "done/../data.csv"],
    ["report", "done", "--out", "done/leaderboard.json"],
    ["diagnose", "data.csv", *MODEL, "--report", "data.csv"],
    ["compare", "data.csv", *MODEL, "--report", "link.csv"],
    ["improve", "data.csv", "--model", "model.json", "--out", "."],
    ["info", "data.csv", "info.json", "--out", "."],
    ["simulate", "model.json", "--torque", "data.csv", "--out", "data.csv"],
    ["simulate", "rig.yaml", "--out", "rig.yaml"],
    ["export", "model.json", "--to", "c", "--out", "model.json"],
    ["export", "model.json", "--to", "c", "--data", "data.csv", "--out", "data.csv"],
    ["export", "model.json", "--to", "mjcf", "--into", "rig.yaml", "--out", "rig.yaml"],
    ["sums", "data.sums.json", "--model", "coulomb-viscous", "--out", "data.sums.json"],
    ["sums", "data.csv", "--model", "coulomb-viscous", "--like", "data.sums.json", "--out", "."],
    ["compensate", "rig.yaml", "--out", "rig.yaml"],
    ["run", "bench.yaml", "--report", "data.csv"],
    ["run", "bench.yaml", "--report", "bench.yaml"],
    ["leaderboard", "done", "--format", "csv", "--out", "done/leaderboard.json"],
]


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_an_output_that_is_an_input_is_refused(
    command: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def content() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    before = content()
    capsys.readouterr()
    with pytest.raises(SystemExit) as ended:
        main(command)
    said = capsys.readouterr().err.strip().splitlines()
    assert ended.value.code == 2
    assert len(said) == 1
    assert "would be overwritten" in said[0]
    named = said[0].removeprefix("error: ").partition(":")[0]
    assert Path(named).is_relative_to(command[-1])
    assert (folder / named).exists()
    assert content() == before


def test_a_file_of_its_own_is_not_refused(folder: Path) -> None:
    check_outputs([folder / "new.json", None], [Path("data.csv"), "coulomb-viscous", None])
    check_outputs([Path("report.html")], [Path("data.csv"), Path("missing.csv")])


def test_every_file_of_a_folder_that_is_read_is_one(folder: Path) -> None:
    with pytest.raises(InputError, match=r"leaderboard\.json"):
        check_outputs([Path("done/leaderboard.json")], [Path("done")])
