"""What `fricmodels new` writes installs, passes its exam, is listed, and takes part in a tournament."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from fricmodels.cli import main
from fricmodels.errors import InputError
from fricmodels.scaffold import KINDS, write

CONFIG = """\
datasets:
  - name: log
    files: motor.bearing-reader
    inertia: 4.87e-6
  - name: simulated
    simulate: {model: coulomb-viscous, parameters: {K_v: 1.0e-4, K_c: 0.01}, inertia: 4.87e-6, amplitude: 0.03,
               frequency: 39.54, noise_percent: 2}
models: [coulomb-viscous, bearing-law, coulomb-viscous+bearing-effect]
estimators: [batch, bearing-estimator]
simulate: false
timeout: 60
"""


@pytest.mark.long
def test_as_generated_they_install_pass_are_listed_and_take_part(environment: Any, tmp_path: Path) -> None:
    projects = [write(kind, f"bearing-{kind}", tmp_path) for kind in KINDS]
    environment.install(*projects)

    for kind in KINDS:
        listed = environment.run("fricmodels", "list", f"{kind}s")
        assert f"fricmodels-bearing-{kind}" in listed.stdout
        assert not listed.stderr
    tests = [str(project / "tests") for project in projects]
    done = environment.run("pytest", "-q", "-W", "error", "-p", "no:cacheprovider", *tests, cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    checked = environment.run("fricmodels", "check", "fricmodels-bearing-effect")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "effect bearing-effect" in checked.stdout

    _write_log(tmp_path / "motor.bearing-reader")
    (tmp_path / "config.yaml").write_text(CONFIG)
    run = environment.run("fricmodels", "run", "config.yaml", "--out", "out", "--jobs", "1", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    rows = json.loads((tmp_path / "out" / "leaderboard.json").read_text())["rows"]
    found = {(row["dataset"], row["model"], row["estimator"]): row for row in rows}
    assert len(found) == 2 * 3 * 2
    for (_, model, estimator), row in found.items():
        cannot = estimator == "bearing-estimator" and model.endswith("bearing-effect")
        assert row["status"] == ("failed" if cannot else "ok"), row
    for dataset in ("log", "simulated"):
        for estimator in ("batch", "bearing-estimator"):
            parameters = found[dataset, "coulomb-viscous", estimator]["parameters"]
            assert parameters["K_c"] == pytest.approx(0.01, rel=0.1)


def _write_log(path: Path) -> None:
    import numpy as np

    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.simulation import simulate

    time = 2e-3 * np.arange(3000)
    drive = Drive(Model.parse("coulomb-viscous"), 4.87e-6)
    recording = simulate(drive, {"K_v": 1e-4, "K_c": 0.01}, time, 0.03 * np.sin(20 * time), substeps=4)
    rows = np.column_stack([recording.time, recording.torque, recording.velocity])
    np.savetxt(path, rows, header="time_s torque_Nm velocity_rad_s", comments="")


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["law", "Bearing"], "cannot be a name"),
        (["law", "bearing_drag"], "cannot be a name"),
        (["law", "-x"], "No such option"),
        (["law", "2nd"], "cannot be a name"),
        (["law", "../up"], "cannot be a name"),
        (["law", "lambda"], "word of Python"),
        (["effect", "cogging"], "name of an effect already"),
        (["effect", "batch"], "name of an estimator already"),
        (["motor", "x"], "is not one of"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    arguments: list[str], reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["new", *arguments, "--out", str(tmp_path)])
    errors = capsys.readouterr().err
    assert stopped.value.code == 2
    assert len(errors.splitlines()) == 1
    assert reason in errors
    assert not list(tmp_path.iterdir())


def test_an_existing_directory_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "fricmodels-drag").mkdir()
    (tmp_path / "fricmodels-drag" / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="is there already"):
        write("law", "drag", tmp_path)
    assert [path.name for path in tmp_path.rglob("*")] == ["fricmodels-drag", "mine.txt"]


def test_nothing_half_written_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(InputError, match="No space left"):
        write("law", "drag", tmp_path)
    assert not list(tmp_path.iterdir())
