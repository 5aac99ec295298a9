"""JSON files, in the shapes in which programs write their logs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.errors import InputError
from fricmodels.logcheck import findings
from fricmodels.readers import read
from fricmodels.readers.json import JsonReader

TIME = 0.01 * np.arange(60)
POSITION = np.sin(3.0 * TIME)
TORQUE = np.cos(2.0 * TIME)
MAPPED = ("time=t", "position=q", "torque=tau")


def records() -> list[dict[str, Any]]:
    return [
        {"t": t, "q": q, "tau": u} for t, q, u in zip(TIME.tolist(), POSITION.tolist(), TORQUE.tolist(), strict=True)
    ]


def lists() -> dict[str, list[float]]:
    return {"t": TIME.tolist(), "q": POSITION.tolist(), "tau": TORQUE.tolist()}


def write(path: Path, content: object) -> Path:
    path.write_text(json.dumps(content))
    return path


def assert_read(path: Path, columns: tuple[str, ...] = MAPPED) -> None:
    found = read(path, columns=columns)
    for channel, values in (("time", TIME), ("position", POSITION), ("torque", TORQUE)):
        assert np.allclose(found[channel], values, rtol=0.0, atol=1e-14)


SHAPES: dict[str, tuple[object, tuple[str, ...]]] = {
    "objects": (records(), MAPPED),
    "lists": (lists(), MAPPED),
    "entries beside other things": ({"mass": 0.5, "motor": "m", "kp": 32, "entries": records()}, MAPPED),
    "lists beside other things": ({"rate": 100.0, "log": lists(), "tags": ["a", "b"], "empty": []}, MAPPED),
    "as pandas writes a table": (json.loads(pd.DataFrame(records()).to_json(double_precision=15)), MAPPED),
    "as pandas writes its rows": (json.loads(pd.DataFrame(records()).T.to_json(double_precision=15)), MAPPED),
    "nested": (
        [{"stamp": {"s": r["t"]}, "joint": {"q": r["q"], "tau": r["tau"]}} for r in records()],
        ("time=stamp.s", "position=joint.q", "torque=joint.tau"),
    ),
    "vectors": (
        [{"t": r["t"], "q": [0.0, r["q"]], "tau": [r["tau"], 1.0, 2.0]} for r in records()],
        ("time=t", "position=q(2)", "torque=tau(1)"),
    ),
    "matrices": (
        {
            "t": TIME.tolist(),
            "q": [[r["q"], 0.0] for r in records()],
            "tau": [[1.0, r["tau"]] for r in records()],
        },
        ("time=t", "position=q(1)", "torque=tau(2)"),
    ),
    "rows without names": ([[*r.values()] for r in records()], ("time=1", "position=2", "torque=3")),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_samples_in_every_shape(tmp_path: Path, shape: str) -> None:
    content, columns = SHAPES[shape]
    assert_read(write(tmp_path / "log.json", content), columns)


@pytest.mark.parametrize("suffix", [".json", ".jsonl", ".ndjson"])
def test_an_object_a_line(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"log{suffix}"
    path.write_text("\n".join(json.dumps(row) for row in records()) + "\n\n")
    assert_read(path)


def test_tables_of_several_tests_are_runs(tmp_path: Path) -> None:
    """As the logs of a robot's characterization: time, voltage, position and velocity of each test."""
    rows = [[*r.values()] for r in records()]
    content = {"sysid": True, "units": "Radians", "fast-forward": rows[:25], "slow-backward": rows[25:]}
    path = write(tmp_path / "log.json", content)
    table = JsonReader().table(path)
    assert list(table.columns) == ["1", "2", "3", "run"]
    assert table["run"].tolist() == ["fast-forward"] * 25 + ["slow-backward"] * 35
    found = read(path, columns=("time=1", "position=2", "torque=3"))
    assert len(np.unique(found.run)) == 2


def test_what_is_missing_is_found_at_its_row(tmp_path: Path) -> None:
    rows = records()
    del rows[7]["tau"]
    with pytest.raises(InputError, match=r"row 8, torque .*empty|row 8, torque .*NaN"):
        read(write(tmp_path / "log.json", rows), columns=MAPPED)
    lined = tmp_path / "log.jsonl"
    lined.write_text("\n\n".join(json.dumps(row) for row in rows))
    with pytest.raises(InputError, match="line 15, torque"):
        read(lined, columns=MAPPED)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"t": [1, 2}', "line 1 is no JSON"),
        ('{"t": 1}\n{"t": 2}\n{"t": ', "line 3 is no JSON"),
        ('[\n{"t": 1},\n{"t" 2}]', "line 3 is no JSON"),
        ("", "the file is empty"),
        ("3.4", "holds no lists of numbers"),
        ('{"name": "drive", "kp": 3}', "holds no lists of numbers"),
        ("[" * 100_000, "no JSON|nested too deeply"),
        ('{"a": [1, [2]]}', "holds no lists of numbers"),
    ],
)
def test_what_is_no_table_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "log.json"
    path.write_text(text)
    with pytest.raises(InputError, match=message) as error:
        read(path, columns=MAPPED)
    assert "\n" not in str(error.value)
    assert "log.json" in str(error.value)


def test_what_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "log.json").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(InputError, match="no UTF-8 text"):
        read(tmp_path / "log.json")


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=3), inner, max_size=4),
    max_leaves=12,
)


@given(content=ANYTHING)
def test_any_document_is_a_table_or_one_line(tmp_path_factory: pytest.TempPathFactory, content: object) -> None:
    path = write(tmp_path_factory.mktemp("any") / "log.json", content)
    table, message = None, ""
    try:
        table = JsonReader().table(path)
    except InputError as error:
        message = str(error)
    assert len(message.splitlines()) == 1 if table is None else len(table) > 1


def test_a_list_that_is_a_sample_short_is_told(tmp_path: Path) -> None:
    content = {"time_s": TIME.tolist(), "torque_Nm": TORQUE.tolist(), "velocity_rad_s": POSITION.tolist()}
    path = write(tmp_path / "short.json", {**content, "position_rad": TORQUE.tolist()[:-1], "notes": [1.0, 2.0]})
    said = [str(finding) for finding in findings(read(path)) if finding.kind == "unused-column"]
    cause, way_out = "it has 59 values, where the others have 60", "save all columns with one length"
    assert said == [f"the column 'position_rad' is not used: {cause}; {way_out}"]


@pytest.mark.parametrize("inside", [False, True])
def test_a_list_of_tests_with_lists_of_samples_is_runs(tmp_path: Path, inside: bool) -> None:
    tests = [
        {"kind": "drop", "limits": [-1, 1], "t": [0.01 * i for i in range(n)], "q": [float(n)] * n} for n in (9, 7)
    ]
    path = tmp_path / "tests.json"
    for some, runs in ((tests, 2), (tests[:1], 1)):
        path.write_text(json.dumps({"rate": [50, 60], "data": some} if inside else some), encoding="utf-8")
        found = JsonReader().table(path)
        assert found["q"].tolist() == [9.0] * 9 + [7.0] * 7 * (runs - 1)
        assert found["t"].tolist() == [0.01 * i for i in range(9)] + [0.01 * i for i in range(7)] * (runs - 1)
        assert ("run" in found) is (runs > 1)
