"""Results show themselves: tables as DataFrames, HTML with nothing in it that anybody else wrote."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from importlib.util import find_spec
from typing import Any

import numpy as np
import pandas as pd
import pytest

from fricmodels import Fit, Recording, improve, notebook
from fricmodels.dimension import Motion
from fricmodels.fit import Status
from fricmodels.rig.demonstration import hidden
from fricmodels.tournament import Leaderboard

EVIL = '</script><script>alert(1)</script><img src=x onerror="alert(2)">&\x1b[31m'
ROW = {
    "model": "coulomb-viscous", "estimator": "batch", "dataset": EVIL, "tags": {"seed": 1, EVIL: EVIL},
    "rms_torque_error_percent": 1.5, "held_out_rms_torque_error_percent": 1.75, "parameters": {"K_v": 1e-4},
    "standard_errors": {"K_v": 1e-6}, "true_parameters": None, "seconds": 0.1, "status": "ok", "message": "",
}  # fmt: skip
FAILED = {
    **ROW, "tags": {"seed": 2, EVIL: "x"}, "status": "failed", "message": EVIL, "rms_torque_error_percent": None,
    "held_out_rms_torque_error_percent": None, "parameters": {}, "standard_errors": {},
}  # fmt: skip


def test_a_recording_says_what_the_check_of_the_log_stops_at() -> None:
    rng, time = np.random.default_rng(0), 0.002 * np.arange(4000)
    velocity = 3.0 * np.sin(4.0 * time) + 2.0 * np.sin(9.0 * time)
    rate = 12.0 * np.cos(4.0 * time) + 18.0 * np.cos(9.0 * time)
    torque = 0.05 * rate + 0.1 * velocity + 0.6 * np.sign(velocity) + 0.01 * rng.standard_normal(len(time))
    for sign, is_said in ((1.0, False), (-1.0, True)):
        channels = {"time": time, "torque": sign * torque, "velocity": velocity}
        recording = Recording("log", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
        said = " ".join(repr(recording).split())
        assert ("Stop: the torque has the wrong sign" in said) is is_said
        assert ("wrong sign" in recording._repr_html_()) is is_said


def test_a_recording_that_is_too_long_to_be_checked_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fricmodels.notebook.page._MOST_CHECKED", 10)
    time = 0.01 * np.arange(20.0)
    recording = Recording("log", Motion.ROTARY, dict.fromkeys(("time", "torque", "velocity"), time), np.zeros(20, int))
    assert "too long to be checked here; 'fricmodels info' does it." in " ".join(repr(recording).split())


class Elements(HTMLParser):
    """The elements of a document, checked to be closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)
        self.seen.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "script" not in self.open:
            self.text += data


@pytest.fixture(scope="session")
def recording() -> Recording:
    return hidden().model_copy(update={"samples": 4_000}).simulate().select(slice(None), name=EVIL)


@pytest.fixture(scope="session")
def results(recording: Recording) -> dict[str, Any]:
    covariance = np.diag([1e-4, 0.25])
    fit = Fit("coulomb-viscous", EVIL, EVIL, {"K_v": 1.0, "K_c": 2.0, "J": 3.0}, covariance, ("K_v", "K_c"))
    ladder = improve(recording, "coulomb-viscous", 1.8)
    history = pd.DataFrame({"time": [0.0, 1.0, 2.0], "K_v": [0.0, 0.5, 1.0], "K_c": [1.0, 1.5, 2.0]})
    return {
        "recording": recording,
        "fit": fit,
        "history": Fit(**{**vars(fit), "history": history, "not_identified": {"K_c": EVIL}}),
        "failed": Fit(**{**vars(fit), "status": Status.FAILED, "message": EVIL}),
        "comparison": ladder.first.comparison,
        "diagnosis": ladder.first,
        "ladder": ladder,
        "board": Leaderboard.ranked([FAILED, ROW]),
        "empty": Leaderboard(()),
    }


KINDS = ["recording", "fit", "history", "failed", "comparison", "diagnosis", "ladder", "board", "empty"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_shows_itself_and_names_are_escaped(kind: str, results: dict[str, Any]) -> None:
    elements = Elements(results[kind]._repr_html_())
    assert {tag for tag, _ in elements.seen} <= {
        "div", "p", "strong", "script", "details", "summary", "table", "thead", "tbody", "tr", "th", "td",
    }  # fmt: skip
    assert all(not name.startswith("on") for _, attributes in elements.seen for name in attributes)
    figures = [attributes["id"] for tag, attributes in elements.seen if attributes.get("class") == "fricmodels-figure"]
    assert len(set(figures)) == len(figures) == sum(tag == "script" for tag, _ in elements.seen)
    if kind in ("recording", "comparison", "diagnosis", "ladder"):
        assert ("alert(1)" in elements.text) == (kind in ("recording", "comparison"))


@pytest.mark.parametrize("kind", KINDS)
def test_tables_are_frames_and_all_of_their_numbers_are_shown(kind: str, results: dict[str, Any]) -> None:
    result = results[kind]
    tables = result.tables()
    pd.testing.assert_frame_equal(result.table(), next(iter(tables.values())))
    if kind in ("board", "empty"):
        return
    shown = Elements(result._repr_html_()).text
    for title, table in tables.items():
        assert title in shown
        for name in table.select_dtypes("float"):
            for value in table[name].dropna():
                assert f"{value:.5g}" in shown, (title, name)


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_printed_is_short(kind: str, results: dict[str, Any]) -> None:
    text = repr(results[kind])
    assert len(text.splitlines()) < 30
    assert "array(" not in text


@pytest.mark.skipif(find_spec("plotly") is None, reason="figures need plotly")
@pytest.mark.parametrize(
    ("kind", "count"), [("fit", 0), ("history", 1), ("comparison", 3), ("diagnosis", 2), ("ladder", 2), ("board", 1)]
)
def test_figures_are_drawn_where_plotly_is(kind: str, count: int, results: dict[str, Any]) -> None:
    assert results[kind]._repr_html_().count("fricmodels-figure") == count


@pytest.mark.parametrize("kind", KINDS)
def test_without_plotly_there_are_tables(kind: str, results: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fricmodels.notebook.figures.find_spec", lambda name: None)
    text = results[kind]._repr_html_()
    assert "<script" not in text
    assert "<table" in text or kind == "empty"
    assert text.count("<details open") == text.count("<details")


def test_what_is_no_result_is_refused() -> None:
    for show in (notebook.html, notebook.text, notebook.tables):
        with pytest.raises(TypeError, match="int"):
            show(3)


def test_the_tables_say_what_the_results_hold(results: dict[str, Any]) -> None:
    fit = results["history"].table()
    assert fit.loc["K_c", "standard error"] == pytest.approx(0.5)
    assert fit.loc["J", "remark"] == "given"
    assert fit.loc["K_c", "remark"] == EVIL
    comparison = results["comparison"]
    table = comparison.table()
    assert table["value"].to_dict() == dict(comparison.estimate.parameters)
    assert table.loc["K_v", "unit"] == "N m s/rad"
    where = comparison.tables()["Where it fails"]
    assert where.loc["forward", "share of samples [%]"] + where.loc["backward", "share of samples [%]"] < 100
    ladder = results["ladder"]
    assert list(ladder.table()["added"]) == ["", "cogging", "stribeck"]
    assert ladder.table()["test error [%]"].is_monotonic_decreasing
    assert ladder.tables()["Parameters from step to step"].loc["cogging.k", "step 2"] == pytest.approx(7.3, rel=1e-3)
    assert results["diagnosis"].table().index[0] == "cogging"
    board = results["board"].table()
    assert list(board["status"]) == ["ok", "failed"]
    assert board.loc[0, "parameter.K_v"] == 1e-4


def test_a_linear_axis_has_its_units() -> None:
    channels = {"time": np.arange(3.0), "torque": np.ones(3), "velocity": np.ones(3), "temperature": np.full(3, 20.0)}
    recording = Recording("axis", Motion.LINEAR, channels, np.zeros(3, dtype=np.int64))
    assert recording.table()["unit"].to_dict() == {"time": "s", "torque": "N", "velocity": "m/s", "temperature": "°C"}


def test_equal_figures_on_one_page_have_places_of_their_own(results: dict[str, Any]) -> None:
    comparison = results["comparison"]
    places = re.findall(r'<div id="([^"]+)"', comparison._repr_html_() + comparison._repr_html_())
    assert len(set(places)) == len(places)
