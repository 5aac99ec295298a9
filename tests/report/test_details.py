"""Details of the report that were wrong once."""

from __future__ import annotations

import re
import time
from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.cli import printing
from fricmodels.diagnosis.comparison import Comparison, compare_model, kept_back
from fricmodels.diagnosis.document import comparison_document
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.parameter import at_bound
from fricmodels.recording import Recording
from fricmodels.report import figures, sections, story
from fricmodels.report.figures.style import unit_text
from fricmodels.report.parameters import parameters
from fricmodels.report.provenance import recording
from fricmodels.report.render import render
from fricmodels.report.wording import unit
from fricmodels.results.comparison import ComparisonDocument
from fricmodels.weakform.prepared import ready

Made = Callable[..., Recording]


@pytest.fixture(scope="module")
def linear(made: Made) -> Comparison:
    train, test = kept_back(ready(made(motion=Motion.LINEAR, samples=4000)))
    return compare_model(train, test, Drive(Model.parse("coulomb-viscous"), 2.0, Motion.LINEAR))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("N m s^2/rad^2", "N m s²/rad²"),
        ("kg m^2/s^10", "kg m²/s¹⁰"),
        ("N s^(1/2)/m^(1/2)", "N s¹ᐟ²/m¹ᐟ²"),
        ("1/s^-2", "1/s⁻²"),
    ],
)
def test_an_exponent_ends_where_it_ends(text: str, expected: str) -> None:
    assert unit(text) == expected
    assert "<sup>2/" not in unit_text(text)


def test_a_linear_axis_has_no_torque_in_its_words(linear: Comparison) -> None:
    page = story.of_comparison(linear)
    assert "force" in page.verdict.sentence
    shown = re.sub(
        r"<script.*?</script>|<style>.*?</style>|load torque|motor torque", "", render(page), flags=re.DOTALL
    )
    words = re.findall(r"[^.<>]*\btorque\b[^.<>]*", shown)
    assert not [text for text in words if "N m" in text or "Torque over" in text]
    for tile in page.tiles:
        assert "torque" not in tile.label


def test_the_floor_of_ours_is_said_once() -> None:
    floor = 100 * POLICY.least_torque
    assert sections.floor_words([floor, floor, 4.0]).count("0.300") == 1
    assert sections.floor_words([2.0, None]) == ""


def test_a_velocity_that_was_replaced_says_why(linear: Comparison) -> None:
    data = comparison_document(linear)
    own = {"source": "log.csv", "interval": 0.002, "derived": ("acceleration", "velocity")}

    def read(*columns: str) -> ComparisonDocument:
        known = data.recording.model_copy(update={**own, "columns": columns})
        return data.model_copy(update={"recording": known})

    rows = dict(recording(read("velocity=qd", "time=t")).rows)
    assert "more certain" in rows["derived"]
    assert rows["sampling"] == "every 2 ms"
    assert dict(recording(read("time=t")).rows)["derived"] == "acceleration, velocity"


def test_a_parameter_at_its_bound_is_named() -> None:
    declared = {p.key: p.declared for p in Model.parse("coulomb-viscous").parameters}
    assert at_bound(declared, {"K_v": 0.0, "K_c": 3.0}) == ["K_v"]
    assert at_bound(declared, {"K_v": 1e-9, "K_c": None}) == []
    table = parameters("coulomb-viscous", {"K_v": 0.0, "K_c": 3.0}, {"K_v": 0.0, "K_c": 0.1}, Motion.ROTARY, "")
    assert ["bound" in row[2] for row in table.rows] == [True, False]


def test_hover_names_its_units(linear: Comparison) -> None:
    shown = [figures.friction_curve(linear), figures.residual_map(linear), figures.residual_spectrum(linear)]
    for figure in [*shown, figures.hysteresis(linear)]:
        for trace in figure.data:
            template = trace.hovertemplate or ""
            for value in re.findall(r"%\{[xy][^}]*\}(.{0,3})", template):
                assert value.strip().startswith(("N", "m", "1", "r")), template


def test_borders_of_runs_are_marked(made: Made) -> None:
    from dataclasses import replace

    whole = made(samples=6000)
    run = np.repeat(np.arange(6), 1000)
    train, test = kept_back(ready(replace(whole, run=run)))
    figure = figures.overlay(compare_model(train, test, Drive(Model.parse("coulomb-viscous"), 2.0)))
    assert "border of runs" in [trace.name for trace in figure.data]
    borders = {shape.x0 for shape in figure.layout.shapes if shape.type == "line"}
    assert len(borders) == 5


def test_a_pipe_gets_a_line_each_few_seconds_with_the_step(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(printing, "_EVERY", 0.05)
    with printing.working("improving") as say:
        say("testing effects")
        time.sleep(0.2)
    lines = capsys.readouterr().err.splitlines()
    assert 1 <= len(lines) < 6
    assert all(re.fullmatch(r"testing effects … \d s", line) for line in lines)
    with printing.working("quick"):
        pass
    assert capsys.readouterr().err == ""
