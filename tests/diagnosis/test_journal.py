"""A ladder that is interrupted goes on where it was, to the same end, bit for bit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import _run
from fricmodels.diagnosis import journal as kept
from fricmodels.diagnosis.journal import FILE, Journal


def arm(path: Path) -> str:
    time_s = 0.004 * np.arange(2500)
    velocity = 3.0 * np.sin(2.1 * time_s) + 1.5 * np.sin(5.3 * time_s)
    slope = 6.3 * np.cos(2.1 * time_s) + 7.95 * np.cos(5.3 * time_s)
    position = -3.0 / 2.1 * np.cos(2.1 * time_s) - 1.5 / 5.3 * np.cos(5.3 * time_s)
    torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity) + 0.2 * np.sin(position)
    noisy = velocity + 0.01 * np.random.default_rng(1).standard_normal(len(time_s))
    rows = np.column_stack([time_s, torque, noisy, position])
    np.savetxt(path, rows, delimiter=",", header="time_s,torque_Nm,velocity_rad_s,position_rad", comments="")
    return str(path)


@pytest.mark.long
def test_an_interrupted_improvement_goes_on_to_the_same_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    data = arm(tmp_path / "arm.csv")
    command = ["improve", data, "--model", "coulomb-viscous", "--inertia", "0.05", "--out"]
    assert _run([*command, str(tmp_path / "whole")]) == 0
    steps = 0
    step = Journal.step

    def counted(self: Journal, *arguments: object) -> object:
        nonlocal steps
        steps += 1
        if steps in stops:
            raise KeyboardInterrupt
        return step(self, *arguments)  # type: ignore[arg-type]

    stops = {3, 30, 60}
    monkeypatch.setattr(Journal, "step", counted)
    out = tmp_path / "out"
    for number in range(4):
        capsys.readouterr()
        code = _run([*command, str(out)])
        said = capsys.readouterr().err
        if code == 0:
            break
        assert code == 130
        assert (out / FILE).is_file()
        assert ("going on after" in said) == (number > 0)
        with (out / FILE).open("a") as stream:
            stream.write('{"step": "half a li')  # as a kill leaves it
    assert steps > 60, "all three interruptions came"
    assert sorted(path.name for path in out.iterdir()) == sorted(path.name for path in (tmp_path / "whole").iterdir())
    for name in ("diagnosis.json", "model.json"):
        assert (out / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_what_another_ladder_left_is_not_taken(tmp_path: Path) -> None:
    one = Journal(tmp_path / FILE, "one")
    assert one.step("a", lambda: 1.5, float, float) == 1.5
    assert len(Journal(tmp_path / FILE, "one")) == 0, "it is in use"  # and let go of at once
    one.close()
    again = Journal(tmp_path / FILE, "one")
    assert len(again) == 1
    assert again.step("a", lambda: 2.5, float, float) == 1.5
    again.close()
    other = Journal(tmp_path / FILE, "two")
    assert len(other) == 0
    assert other.step("a", lambda: 2.5, float, float) == 2.5
    other.close()
    lines = (tmp_path / FILE).read_text().splitlines()
    assert [json.loads(line) for line in lines] == [
        {"schema": kept._SCHEMA, "of": "two"},
        {"step": "a", "found": 2.5, "check": kept._check("a", 2.5)},
    ]
    unlike = Journal(tmp_path / FILE, "two")
    assert unlike.step("b", lambda: 3.5, float, float) == 3.5
    assert not (tmp_path / FILE).exists(), "a journal of other steps is no help"
    unlike.close()


def test_without_a_place_for_it_the_ladder_is_the_same(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    journal = Journal(tmp_path / "file" / FILE, "one")
    assert journal.step("a", lambda: 1.5, float, float) == 1.5
    for text in ("no json\n", '{"schema": 1}\n', "[]\n[]\n"):
        (tmp_path / FILE).write_text(text)
        spoilt = Journal(tmp_path / FILE, "one")
        assert len(spoilt) == 0
        spoilt.remove()
