"""Controllers that a plugin brings: given by name, examined, kept in the model's file and taken from there."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from fricmodels import Parameter, plugins
from fricmodels.cli import main
from fricmodels.errors import InputError
from fricmodels.loop import Loop
from fricmodels.motion import Controller, PluginController, read_controller, stored_controller
from fricmodels.plugins import Registered
from fricmodels.saved import load
from fricmodels.saved.controlled import closed_loop, controller_of
from fricmodels.testing import ControllerExam
from fricmodels.testing.faults import Fault


def code(arguments: list[str]) -> int:
    """Exit code of a command."""
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    return int(ended.value.code or 0)


class Servo(Loop):
    """τ_m = k (r − q) − d ω."""

    name = "own-servo"
    channels = ("other.goal",)
    k = Parameter("k", unit="N m", initial=5.0, lower=0.0, meaning="stiffness [N m/rad]")
    d = Parameter("d", unit="N m s", initial=0.3, lower=0.0, meaning="damping")

    def motor_torque(self, s: Any, p: Any) -> Any:
        return p.k * (s["other.goal"] - s.position) - p.d * s.velocity


@pytest.fixture(autouse=True)
def brought(monkeypatch: pytest.MonkeyPatch) -> None:
    entries = plugins.load().controllers._entries
    monkeypatch.setitem(entries, "own-servo", Registered(Servo, "own-servos"))


class TestServo(ControllerExam):
    controller = Servo


@pytest.mark.parametrize("name", ["xl330-firmware", "xl330-sagging-supply"])
def test_the_servo_on_the_bench_passes(name: str) -> None:
    from fricmodels.testing.sitting import checks, exam_of, sit

    exam = exam_of("controller", plugins.load().controllers[name])
    results = {check: sit(exam, check) for check in checks(exam)}
    assert all(outcome.good for outcome in results.values()), results


def test_what_is_wrong_with_a_controller_is_said() -> None:
    def exam(**body: Any) -> ControllerExam:
        body = {"__doc__": "Law.", "name": "bad", "motor_torque": Servo.motor_torque, **body}
        kind = type("Bad", (Servo,), body)
        return type("Exam", (ControllerExam,), {"controller": kind})()

    with pytest.raises(Fault, match="lower case"):
        exam(name="My Servo").test_declaration()
    with pytest.raises(Fault, match=r"'other\.goal'"):
        exam(channels=("goal",)).test_declaration()
    with pytest.raises(Fault, match="'d' changes nothing"):
        exam(motor_torque=lambda self, s, p: p.k * (s["other.goal"] - s.position)).test_parameters_matter()
    with pytest.raises(Fault, match=r"use s\.velocity"):
        exam(motor_torque=lambda self, s, p: s["other.else"]).test_torque_is_an_expression()
    with pytest.raises(Fault, match="no number from"):
        exam(motor_torque=lambda self, s, p: p.d * p.k * s["other.goal"] + 1e9 * s.velocity).test_drives_a_simulation()
    with pytest.raises(Fault, match="fixed"):
        exam(__init__=lambda self: Loop.__init__(self)).test_values_may_be_given()


def test_a_controller_is_given_by_its_name(tmp_path: Path) -> None:
    file = tmp_path / "servo.yaml"
    file.write_text("kind: own-servo\nvalues: {k: 4.0}\n")
    given = read_controller(file)
    assert isinstance(given, PluginController)
    assert given.channels == ("other.goal",)
    assert given.loop().fixed == {"k": 4.0}
    assert stored_controller(given.model_dump(mode="json")) == given
    for text, what in (
        ("kind: own-serve\n", "own-servo"),
        ("kind: pdd\nreference: r\n", "'pd'"),
        ("kind: own-servo\nvalues: {q: 1}\n", "no parameter 'q'"),
        ("kind: own-servo\ngain: 1\n", "gain"),
    ):
        file.write_text(text)
        with pytest.raises(InputError, match=what):
            read_controller(file)
    file.write_text("kind: pd\nreference: r\ngain: 2\n")
    assert isinstance(read_controller(file), Controller)


class TestKept:
    """`fit --controller` keeps it; `compare` and `simulate` take it from there."""

    header: ClassVar[str] = "time_s,torque_Nm,position_rad,goal\n"

    @pytest.fixture
    def data(self, tmp_path: Path) -> Path:
        from fricmodels.drive import Drive
        from fricmodels.model import Model
        from fricmodels.motion import Simulator
        from fricmodels.recording import Recording

        time = np.arange(3000) * 2e-3
        goal = np.sin(4 * time) + 0.5 * np.sin(11 * time)
        zero = np.zeros(3000)
        channels = {"time": time, "torque": zero, "velocity": zero, "position": zero, "other.goal": goal}
        drive = Drive(Model.parse("coulomb-viscous"), 0.01)
        empty = Recording("x", drive.motion, channels, zero.astype(np.int64))
        true = {"K_v": 0.02, "K_c": 0.03, "loop.k": 4.0, "loop.d": 0.2}
        position, velocity = Simulator(drive, empty, loop=Servo())(true)
        torque = 4.0 * (goal - position) - 0.2 * velocity
        table = np.column_stack([time, torque, position, goal])
        path = tmp_path / "data.csv"
        np.savetxt(path, table, delimiter=",", header=self.header.strip(), comments="")
        return path

    def test_from_fit_to_simulate(self, data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        servo, out = tmp_path / "servo.yaml", tmp_path / "joint.model.json"
        servo.write_text("kind: own-servo\nvalues: {d: 0.2}\n")
        same = ["--column", "other.goal=goal"]
        fit = ["fit", str(data), "--model", "coulomb-viscous", "--inertia", "0.01", "--objective", "position"]
        assert code([*fit, "--controller", str(servo), "--out", str(out), *same]) == 0
        model = load(out)
        stored = model.document.controller
        assert stored is not None
        assert stored.settings == {"kind": "own-servo", "values": {"d": 0.2}}
        assert stored.distribution == "own-servos"
        assert set(stored.parameters) == {"k"}
        assert stored.parameters["k"].value == pytest.approx(4.0, rel=0.01)
        assert isinstance(controller_of(model), PluginController)
        capsys.readouterr()
        simulated = tmp_path / "motion.csv"
        assert code(["simulate", str(out), "--reference", str(data), "--out", str(simulated), *same]) == 0
        said = capsys.readouterr().out
        assert "closed loop" in said
        assert float(said.split("position: RMS error ")[1].split()[0]) < 2e-3
        compared = ["compare", str(data), "--model", str(out), "--fixed", "--score", "position", *same]
        assert code(compared) == 0
        assert "through the controller" in capsys.readouterr().out

    def test_what_is_missing_is_said(self, data: Path, tmp_path: Path) -> None:
        out = tmp_path / "joint.model.json"
        code(["fit", str(data), "--model", "coulomb-viscous", "--inertia", "0.01", "--out", str(out)])
        from fricmodels import read

        with pytest.raises(InputError, match="carries no controller"):
            closed_loop(load(out), read(data, columns=["other.goal=goal"]))
        document = load(out).document
        gone = {"settings": {"kind": "gone"}, "distribution": "gone-servos", "version": "1.2"}
        changed = type(document).model_validate({**document.model_dump(by_alias=True), "controller": gone})
        (tmp_path / "gone.model.json").write_text(changed.to_json())
        with pytest.raises(InputError, match=r"gone-servos 1\.2"):
            controller_of(load(tmp_path / "gone.model.json"))
        assert code(["simulate", str(out), "--out", str(tmp_path / "x.csv")]) == 2
