"""``fit``, ``export``, and the commands that take a model's file in place of its name."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import fricmodels
from fricmodels.cli import main
from fricmodels.cli.measurement import known
from fricmodels.diagnosis.document import comparison_document
from fricmodels.recording import Recording
from fricmodels.saved.driven import write_recording

MODEL = "coulomb-viscous+cogging"


def call(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as stopped:
        main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return int(stopped.value.code or 0), captured.out, captured.err


@pytest.fixture(scope="module")
def room(made: Callable[..., Recording], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a recording of a drive with cogging, and the file of a model fitted to it."""
    folder = tmp_path_factory.mktemp("model-files")
    recording = made(MODEL, {"cogging.a": 0.8, "cogging.k": 7.0}, samples=6000)
    columns = {"time_s": recording.time, "torque_Nm": recording.torque, "velocity_rad_s": recording.velocity}
    pd.DataFrame({**columns, "position_rad": recording["position"]}).to_csv(folder / "joint.csv", index=False)
    fricmodels.keep(fricmodels.compare(fricmodels.read(folder / "joint.csv"), MODEL, 2.0)).save(
        folder / "joint.model.json"
    )
    return folder


def test_fit_writes_what_compare_finds(room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "new" / "joint.model.json"
    code, text, err = call(capsys, "fit", room / "joint.csv", "--model", MODEL, "--inertia", 2.0, "--out", out)
    assert code == 0, err
    assert "K_c" in text
    assert out.read_bytes() == (room / "joint.model.json").read_bytes()
    kept = fricmodels.load(out)
    found = fricmodels.compare(fricmodels.read(room / "joint.csv"), MODEL, 2.0)
    assert kept.parameters == dict(found.estimate.parameters)
    assert kept.parameters["cogging.k"] == pytest.approx(7.0, rel=1e-3)
    assert kept.document.provenance.files == ("joint.csv",)
    assert kept.document.provenance.sha256


def overlay(folder: Path) -> pd.DataFrame:
    return pd.read_csv(folder / "overlay.csv")


def test_compare_starts_from_a_file_and_ends_where_it_would(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = room / "joint.model.json"
    for name, model in (("a", MODEL), ("b", str(file))):
        inertia = ["--inertia", "2.0"] if name == "a" else []  # the file's own
        code, _, err = call(capsys, "compare", room / "joint.csv", "--model", model, *inertia, "--out", tmp_path / name)
        assert code == 0, err
    first, second = overlay(tmp_path / "a"), overlay(tmp_path / "b")
    size = float(np.std(first["measured_Nm"]))
    np.testing.assert_allclose(second["modelled_Nm"], first["modelled_Nm"], atol=1e-5 * size)


def test_fixed_numbers_stay(room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With --fixed the numbers are those of the file, even wrong ones, and the error shows it."""
    content = json.loads((room / "joint.model.json").read_text(encoding="utf-8"))
    content["parameters"]["K_c"]["value"] = 4.0
    wrong = tmp_path / "wrong.model.json"
    wrong.write_text(json.dumps(content), encoding="utf-8")
    found = {}
    for name, model in (("right", room / "joint.model.json"), ("wrong", wrong)):
        out = tmp_path / name
        code, _, err = call(capsys, "compare", room / "joint.csv", "--model", model, "--fixed", "--out", out)
        assert code == 0, err
        found[name] = overlay(out)
    moved = found["wrong"]["modelled_Nm"] - found["right"]["modelled_Nm"]
    missing = 4.0 - fricmodels.load(room / "joint.model.json").parameters["K_c"]
    assert float(np.median(np.abs(moved))) == pytest.approx(missing, rel=1e-3)


def test_a_file_with_another_window_is_compared_over_that(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the file promises is over its own window; the error of the recording over that one stands beside it."""
    content = json.loads((room / "joint.model.json").read_text(encoding="utf-8"))
    here = content["error"]["window_ms"]
    held = known(fricmodels.load(room / "joint.model.json"), fixed=True)
    document = comparison_document(fricmodels.compare(fricmodels.read(room / "joint.csv"), held, 2.0))
    assert document.promised_percent == content["error"]["test_percent"]
    windows = [band.window_ms for band in document.rms_torque_error.bands[1:] if band.window_ms]
    other = next(window for window in windows if window != here)
    content["error"].update(window_ms=other, test_percent=7.25)
    file = tmp_path / "other.model.json"
    file.write_text(json.dumps(content), encoding="utf-8")
    for model, said in ((room / "joint.model.json", False), (file, True)):
        _, out, _ = call(capsys, "compare", room / "joint.csv", "--model", model, "--fixed")
        text = " ".join(out.split())
        assert (f"Over {other:.3g} ms, as in the file of the model" in text) == said
        assert ("the file says 7.25 %" in text) == said


def test_what_goes_beyond_the_range_of_a_file_is_said(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A model that was fitted to slow motion says nothing that was measured of a fast one."""
    content = json.loads((room / "joint.model.json").read_text(encoding="utf-8"))
    velocity = fricmodels.read(room / "joint.csv").velocity
    slow = float(np.quantile(np.abs(velocity), 0.7)) / 1.1  # and a twentieth of the range on each side is allowed
    content["range"]["velocity"].update(least=-slow, greatest=slow)
    file = tmp_path / "slow.model.json"
    file.write_text(json.dumps(content), encoding="utf-8")
    for model, fixed, said in ((room / "joint.model.json", True, False), (file, True, True), (file, False, False)):
        _, out, _ = call(capsys, "compare", room / "joint.csv", "--model", model, *(["--fixed"] if fixed else []))
        text = " ".join(out.split())
        assert ("30 % of the samples have a velocity beyond" in text) == said
        assert ("where the numbers were fitted" in text) == said


@pytest.mark.parametrize(("inertia", "said"), [(5.0, True), (2.0, False), (None, False)])
def test_an_inertia_in_the_place_of_the_files_is_said(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], inertia: float | None, said: bool
) -> None:
    given = [] if inertia is None else ["--inertia", inertia]
    model = room / "joint.model.json"
    _, _, err = call(capsys, "compare", room / "joint.csv", "--model", model, "--fixed", *given, "--out", tmp_path)
    assert ("warning: --inertia 5 is taken in the place of the 2 of" in err) == said


@pytest.mark.long
def test_diagnose_holds_a_file_and_improve_leaves_its_own(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bare = tmp_path / "bare.model.json"
    data = room / "joint.csv"
    code, _, err = call(capsys, "fit", data, "--model", "coulomb-viscous", "--inertia", 2.0, "--out", bare)
    assert code == 0, err
    others = [n for n in fricmodels.plugins.load().effects if n != "cogging"]
    out = [part for name in others for part in ("--leave-out", name)]
    code, _, err = call(capsys, "diagnose", data, "--model", bare, "--fixed", *out, "--out", tmp_path / "d")
    assert code == 0, err
    held = json.loads((tmp_path / "d" / "diagnosis.json").read_text(encoding="utf-8"))
    assert held["parameters"] == fricmodels.load(bare).parameters
    assert [effect["name"] for effect in held["effects"]] == ["cogging"]
    code, _, err = call(capsys, "improve", data, "--model", bare, *out, "--out", tmp_path / "i")
    assert code == 0, err
    last = json.loads((tmp_path / "i" / "diagnosis.json").read_text(encoding="utf-8"))["ladder"][-1]
    kept = fricmodels.load(tmp_path / "i" / "model.json")
    assert kept.name == last["model"] == MODEL
    assert kept.parameters == last["parameters"]


def test_simulate_drives_a_file(room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "simulated.csv"
    data, file = room / "joint.csv", room / "joint.model.json"
    code, text, err = call(capsys, "simulate", file, "--torque", data, "--out", out)
    assert code == 0, err
    assert "velocity: RMS error" in text
    simulated, recorded = fricmodels.read(out), fricmodels.read(data)
    np.testing.assert_allclose(simulated.torque, recorded.torque)
    error = float(np.sqrt(np.mean((simulated.velocity - recorded.velocity) ** 2)))
    assert error < 0.1 * float(np.std(recorded.velocity))


def test_simulate_reads_a_log_of_current(room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It asked for a torque constant, and had no option for it."""
    table = pd.read_csv(room / "joint.csv")
    table["current_A"] = table.pop("torque_Nm") / 0.25
    table.to_csv(tmp_path / "current.csv", index=False)
    given = ("simulate", room / "joint.model.json", "--torque", tmp_path / "current.csv", "--out", tmp_path / "x.csv")
    code, _, err = call(capsys, *given)
    assert code == 2
    assert "--torque-constant" in err
    code, _, err = call(capsys, *given, "--torque-constant", 0.25)
    assert code == 0, err
    np.testing.assert_allclose(fricmodels.read(tmp_path / "x.csv").torque, fricmodels.read(room / "joint.csv").torque)


def test_a_held_torque_is_seen_said_and_may_be_said(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same torque moves the drive by steps or by straight lines; from the motion it is seen which it was."""
    file, given = room / "joint.model.json", fricmodels.read(room / "joint.csv")
    model = fricmodels.load(file)
    for way in ("held", "linear"):
        first = {"velocity": 0.0, "position": 0.1}
        moved = model.simulate(given.torque, first, time=given.time, between_samples=way)
        data = write_recording(moved, tmp_path / f"{way}.csv")
        errors = []
        for options in ([], ["--between-samples", "held"], ["--between-samples", "linear"]):
            out = tmp_path / "simulated.csv"
            code, text, err = call(capsys, "simulate", file, "--torque", data, "--out", out, *options)
            assert code == 0, err
            assert ("held between samples" in text) == ((options[-1] if options else way) == "held")
            errors.append(float(np.sqrt(np.mean((fricmodels.read(out).velocity - moved.velocity) ** 2))))
        assert errors[0] == errors[1 if way == "held" else 2] < 0.1 * max(errors)


@pytest.mark.parametrize("target", ["c", "mjcf", "urdf", "isaac", "drake", "ros2", "json"])
def test_export_writes_every_target(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], target: str
) -> None:
    out = tmp_path / "out"
    file = room / "joint.model.json"
    code, text, err = call(capsys, "export", file, "--to", target, "--name", "elbow", "--out", out)
    assert code == 0, err
    assert f"wrote {out}" in text
    assert out.stat().st_size > 50
    code, printed, _ = call(capsys, "export", file, "--to", target, "--name", "elbow")
    assert printed == out.read_text(encoding="utf-8")
    if target in ("urdf", "isaac", "drake", "ros2"):
        assert "left out: cogging" in err


def test_export_refits_to_the_recording(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, data = room / "joint.model.json", room / "joint.csv"
    code, text, err = call(capsys, "export", file, "--to", "drake", "--data", data)
    assert code == 0, err
    assert "was refitted" in err
    assert "% of the model's friction torque" in err
    assert "<dynamics damping=" in text


def test_friction_that_a_target_has_goes_out_as_it_was_fitted(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A wave over position is left out; friction has not to make up for it."""
    code, text, err = call(capsys, "export", room / "joint.model.json", "--to", "urdf", "--data", room / "joint.csv")
    assert code == 0, err
    own = fricmodels.load(room / "joint.model.json").parameters
    assert repr(own["K_v"]) in text
    assert repr(own["K_c"]) in text
    assert "left out: cogging" in err
    assert "was refitted" not in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["compare", "{data}", "--model", "no.model.json"], "no such file"),
        (["compare", "{data}", "--model", "coulomb-viscous", "--fixed"], "--fixed"),
        (["compare", "{data}", "--model", "{file}", "--linear"], "columns of a rotary drive; leave out --linear"),
        (["export", "no.model.json", "--to", "c"], "no such file"),
        (["export", "{file}", "--to", "cpp"], "unknown target"),
        (["export", "{file}", "--to", "mjcf", "--into", "no.xml"], "no such file"),
        (["export", "{file}", "--to", "c", "--name", "1 joint"], "no name in C"),
        (["simulate", "{file}", "--out", "x.csv"], "--torque"),
        (["simulate", "{file}", "--torque", "{data}", "--out", "x.txt"], ".csv or .parquet"),
        (["simulate", "{file}", "--reference", "{data}", "--between-samples", "held", "--out", "x.csv"], "recorded"),
        (["fit", "{data}", "--model", "coulomb-viscos", "--out", "x.model.json"], "did you mean"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    room: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    names = {"data": room / "joint.csv", "file": room / "joint.model.json"}
    code, _, err = call(capsys, *(argument.format(**names) for argument in arguments))
    assert code == 2
    assert message in err
    assert err.count("\n") == 1


def test_a_model_that_is_held_is_not_said_to_be_fitted(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["compare", str(room / "joint.csv"), "--model", str(room / "joint.model.json"), "--fixed"]
    for arguments in (given, [*given, "--verbose"]):
        code, out, _ = call(capsys, *arguments)
        said = " ".join(out.split())
        assert code == 0
        assert "with the numbers of its file" in said
        assert "none of them fitted" in said
        for wrong in ("samples fitted", "Fit error", "fit error", "took no part in fitting", "all that was fitted"):
            assert wrong not in said
