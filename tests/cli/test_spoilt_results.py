"""Results that were changed, cut off or never finished: one line that names the file, and no escape sequences."""

from __future__ import annotations

import copy
import csv
import io
import json
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fricmodels.cli import main
from fricmodels.export import FORMATS, export
from fricmodels.results.leaderboard import LeaderboardDocument
from fricmodels.tournament import load_config, run
from fricmodels.tournament.leaderboard import FILE, Leaderboard
from fricmodels.tournament.running import Interrupted

CONFIG = """\
name: two
datasets:
  - simulate: {model: coulomb-viscous, parameters: {K_v: 1.0e-4, K_c: 0.01}, inertia: 4.87e-6, amplitude: 0.02,
               frequency: 39.54, cycles: 4, samples_per_cycle: 100, seeds: 2}
models: coulomb-viscous
estimators: rls
simulate: false
"""
JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-5, 5)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    (folder / "config.yaml").write_text(CONFIG)
    run(folder / "config.yaml", folder / "run", executor="serial")
    return folder / "run"


@pytest.fixture
def spoilt(made: Path, tmp_path: Path) -> Callable[[str, str], Path]:
    def make(name: str, text: str) -> Path:
        for file in (FILE, "run.json"):
            (tmp_path / file).write_bytes((made / file).read_bytes())
        (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path

    return make


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as stopped:
        main([*arguments])
    captured = capsys.readouterr()
    assert "unexpected" not in captured.err
    assert "\x1b" not in captured.out + captured.err
    return int(stopped.value.code or 0), captured.out, captured.err


def changed(content: dict[str, Any], *path: Any, to: Any) -> str:
    changed = copy.deepcopy(content)
    inner = changed
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = to
    return json.dumps(changed)


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        (("rows",), None, "rows"),
        (("rows",), [1], "rows"),
        (("rows", 0, "status"), "splendid", "status"),
        (("rows", 0, "tags"), [1], "tags"),
        (("rows", 0, "parameters", "K_v"), "5", "K_v"),
        (("rows", 0, "parameters", "K_v"), float("nan"), "NaN is no number"),
        (("rows", 0, "seconds"), 10**400, "too large a number"),
        (("rows", 0, "rms_torque_error_bands"), 7, "rms_torque_error_bands"),
    ],
)
def test_a_changed_leaderboard_is_named(
    path: tuple[Any, ...], value: Any, expected: str, made: Path, spoilt: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = spoilt(FILE, changed(json.loads((made / FILE).read_text()), *path, to=value))
    code, out, error = said(capsys, "leaderboard", str(folder), "--format", "csv")
    assert (code, out) == (2, "")
    assert expected in error
    assert str(folder) in error
    assert "fricmodels run" in error
    assert len(error.splitlines()) == 1


def test_a_leaderboard_holds_what_its_schema_says(made: Path) -> None:
    document = LeaderboardDocument.read(made / FILE, "")
    assert [*document.plain()["rows"]] == [*Leaderboard.read(made).rows]
    assert not any(row.model_extra for row in document.rows)


@pytest.mark.parametrize("text", ["", "[]", "[" * 100_000, "{", '{"schema": "fricmodels/leaderboard/1"}', "\x00"])
@pytest.mark.parametrize("file", [FILE, "run.json"])
def test_files_that_are_something_else(text: str, file: str, spoilt: Any, capsys: pytest.CaptureFixture[str]) -> None:
    folder = spoilt(file, text)
    code, _, error = said(capsys, "report", str(folder), "--out", str(folder / "x.html"))
    assert code == 2
    assert file in error
    assert not (folder / "x.html").exists()


@pytest.mark.long
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_whatever_stands_in_a_leaderboard_it_is_shown_or_refused(data: st.DataObject, made: Path, spoilt: Any) -> None:
    content = json.loads((made / FILE).read_text())
    key = data.draw(st.sampled_from(sorted(content["rows"][0])))
    value = data.draw(JSON)
    folder = spoilt(FILE, changed(content, "rows", 0, key, to=value))
    for form in ("table", "md", "csv", "json", "parquet", "html", "latex"):
        with pytest.raises(SystemExit) as stopped:
            main(["leaderboard", str(folder), "--format", form, "--out", str(folder / "x")])
        assert stopped.value.code in (None, 0, 2)


def test_names_do_not_steer_a_terminal(made: Path, spoilt: Any, capsysbinary: pytest.CaptureFixture[bytes]) -> None:
    folder = spoilt(FILE, changed(json.loads((made / FILE).read_text()), "rows", 0, "dataset", to="a\x1b[2J\u202eb"))
    for form in FORMATS:
        if form != "parquet":
            with pytest.raises(SystemExit):
                main(["leaderboard", str(folder), "--format", form])
            assert b"\x1b" not in capsysbinary.readouterr().out


@pytest.mark.parametrize(
    "name", ["a\r=cmd|'/C calc'!A0", "=1", "＝cmd", " \t=1", "+1", "-1", "@x", "＠x", "x\n=1", "\u202e=x"]
)
def test_no_name_starts_a_formula_or_a_row(name: str, made: Path) -> None:
    row = {**Leaderboard.read(made).rows[0], "dataset": name}
    text = export(Leaderboard((row,)), "csv").decode()
    assert "\r" not in text
    header, only = csv.reader(io.StringIO(text, newline=""))
    cell = only[header.index("dataset")]
    assert cell.lstrip("'\ufffd").strip() == cell.lstrip("'\ufffd")
    assert cell[0] not in "=+-@＝＋－＠"


def test_a_run_that_was_stopped_shows_its_part(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "config.yaml").write_text(CONFIG)
    config = load_config(tmp_path / "config.yaml")

    def stop(done: int, total: int, *_: Any) -> None:
        raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        run(config, tmp_path / "out", executor="serial", report=stop)
    code, out, error = said(capsys, "leaderboard", str(tmp_path / "out"), "--format", "json")
    assert code == 0
    assert len(json.loads(out)["rows"]) == 1
    assert "the run was stopped; this is the part of 1 fit that is kept" in error


def test_a_spoilt_row_of_the_store_is_done_again(tmp_path: Path) -> None:
    (tmp_path / "config.yaml").write_text(CONFIG)
    first = run(tmp_path / "config.yaml", tmp_path / "out", executor="serial")
    with sqlite3.connect(tmp_path / "out" / "results.sqlite") as store:
        store.execute("UPDATE results SET row = '{' WHERE rowid = 1")
    store.close()
    again = run(tmp_path / "config.yaml", tmp_path / "out", executor="serial")
    assert [row["parameters"] for row in again.rows] == [row["parameters"] for row in first.rows]
