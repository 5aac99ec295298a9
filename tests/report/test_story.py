"""The report on a recording says what the diagnosis found, and says the same when made from the files it left."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricmodels.diagnosis import Ladder, compare_model, kept_back, ready
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.document import write as write_document
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.progress import Progress, watched
from fricmodels.report import of_run, story
from fricmodels.report.motion import simulated
from fricmodels.report.page import Block, Code, Equations, Fold, Gallery, Page, Picture, Table, Words
from fricmodels.report.render import render
from fricmodels.report.sections import error_title, found
from fricmodels.results.comparison import LogFinding
from fricmodels.results.diagnosis import DiagnosisDocument, Remaining
from fricmodels.rig.demonstration import hidden


def blocks(page: Page) -> list[Block]:
    found: list[Block] = []

    def coordinate_search(some: object) -> None:
        for block in some:  # type: ignore[attr-defined]
            found.append(block)
            if isinstance(block, Fold | Gallery):
                coordinate_search(block.blocks)

    for section in page.sections:
        coordinate_search(section.blocks)
    return found


def cells(page: Page) -> dict[str, list[tuple[str, ...]]]:
    return {block.caption: block.rows for block in blocks(page) if isinstance(block, Table)}


def drawn(page: Page, name: str) -> Picture:
    return next(block for block in blocks(page) if isinstance(block, Picture) and block.name == name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("story")


@pytest.fixture(scope="module")
def ladder(folder: Path, demonstration: Any) -> Ladder:
    shutil.copy(demonstration.data, folder / "joint.csv")
    found: Ladder = demonstration.ladder
    write_document(document(found.first, found), folder)
    return found


@pytest.fixture(scope="module")
def page(ladder: Ladder) -> Page:
    return story.of_ladder(ladder)


def test_the_verdict_names_what_was_hidden(page: Page) -> None:
    assert page.verdict.sentence == "The model coulomb-viscous lacks two effects: cogging and stribeck."
    assert page.verdict.tone == "warn"
    assert any("poles, slots or teeth" in line for line in page.verdict.details)
    assert [tile.label for tile in page.tiles][:2] == [
        "test error of the model as given",
        "test error with what was found",
    ]


def test_parameters_stand_with_interval_and_unit(page: Page, ladder: Ladder) -> None:
    rows = {row[0]: row for row in cells(page)["coulomb-viscous+cogging+stribeck"]}
    parameters = ladder.rungs[-1].comparison.estimate.parameters
    assert set(rows) == set(parameters)
    assert rows["J"][1:4] == ("1.800", "given", "kg m²")
    for key in ("K_c", "stribeck.F_s"):
        value, half = (float(text.removeprefix("± ")) for text in rows[key][1:3])
        assert value == pytest.approx(parameters[key], abs=half / 2)
        assert rows[key][3] == "N m"
    truth = {"K_v": 6.0, "K_c": 9.0, "stribeck.omega_s": 0.12, "stribeck.delta": 1.5}
    for key, true in truth.items():
        value, half = (float(text.removeprefix("± ")) for text in rows[key][1:3])
        assert abs(value - true) < 3 * half + 0.01 * true


def test_what_could_not_be_seen_stands_with_its_reason(page: Page) -> None:
    rows = {row[0]: row[1:] for row in cells(page)["Effects that this recording cannot show"]}
    assert rows["thermal"] == ("the recording has no temperature", "a temperature that changes")
    seen = " ".join(row[-1] for row in cells(page)["Smallest size that we would have detected"])
    assert "gravity" in seen
    assert "cogging(2)" in seen
    assert re.search(r"cogging(?!\(2\))", seen) is None, "the model has it"


def test_each_figure_has_its_message_and_a_table(page: Page) -> None:
    pictures = [block for block in blocks(page) if isinstance(block, Picture)]
    assert len(pictures) > 10
    assert all(len(picture.message) > 20 for picture in pictures)
    without = [picture.title for picture in pictures if picture.table is None]
    assert without == []
    named = [picture.name for picture in pictures]
    assert named[:3] == ["evidence-cogging", "low-speed", "candidates"]
    assert "with cogging in the model" in pictures[0].message
    spectrum = next(picture for picture in pictures if picture.name == "spectrum")
    line = re.search(r"stands at ([\d.]+) ± ([\d.]+) per turn", spectrum.message)
    assert line is not None
    assert abs(float(line[1]) - 7.3) <= float(line[2]), "the line is named no more finely than it is known"


def test_the_equations_are_those_of_law_and_effects(page: Page) -> None:
    lines = [formula for block in blocks(page) if isinstance(block, Equations) for formula, _ in block.lines]
    assert "τ_law = K_v·ω + K_c·sgn ω" in lines
    assert "τ_F = τ_law + τ_1 + τ_2" in lines


def test_provenance_is_exact(page: Page, folder: Path) -> None:
    import hashlib

    rows = dict(cells(page)["Recording and programs"])
    assert rows["SHA-256 of the file"] == hashlib.sha256((folder / "joint.csv").read_bytes()).hexdigest()
    assert "numpy" in rows["versions"]
    code = next(block for block in blocks(page) if isinstance(block, Code))
    assert "fricmodels improve" in code.text
    assert "--model coulomb-viscous --inertia 1.8" in code.text


@pytest.mark.long
def test_made_from_the_files_the_page_is_the_same(page: Page, folder: Path) -> None:
    assert render(of_run(folder)) == render(of_run(folder / "diagnosis.json"))
    again = of_run(folder)
    assert again.verdict == page.verdict
    assert again.tiles == page.tiles
    assert cells(again).keys() == cells(page).keys()
    assert cells(again)["coulomb-viscous+cogging+stribeck"] == cells(page)["coulomb-viscous+cogging+stribeck"]
    words = error_title(DiagnosisDocument.read(folder / "diagnosis.json", ""))
    ladders = [drawn(each, "ladder-steps").table for each in (again, page)]
    assert ladders[0] == ladders[1]
    assert ladders[0] is not None
    assert ladders[0].caption == f"{words}, in % of the RMS motor torque"
    assert [section.name for section in again.sections] == [section.name for section in page.sections]


def test_without_the_recording_the_words_remain(page: Page, folder: Path, tmp_path: Path) -> None:
    text = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    text["recording"]["source"] = str(tmp_path / "gone.csv")
    (tmp_path / "diagnosis.json").write_text(json.dumps(text), encoding="utf-8")
    bare = of_run(tmp_path)
    assert bare.verdict.sentence == page.verdict.sentence
    assert bare.verdict.lines == page.verdict.lines
    drawn = [block.name for block in blocks(bare) if isinstance(block, Picture)]
    assert drawn == ["candidates", "correlation"], "what needs no recording"
    assert "There are no figures" in render(bare)
    assert "gone.csv" in render(bare)


def test_a_recording_that_changed_is_not_drawn(folder: Path, ladder: Ladder, tmp_path: Path) -> None:
    text = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    changed = (folder / "joint.csv").read_text(encoding="utf-8") + "\n"
    (tmp_path / "joint.csv").write_text(changed, encoding="utf-8")
    text["recording"]["source"] = str(tmp_path / "joint.csv")
    (tmp_path / "diagnosis.json").write_text(json.dumps(text), encoding="utf-8")
    assert "has changed since the diagnosis" in render(of_run(tmp_path))


def test_a_comparison_says_where_it_fails_and_nothing_more(ladder: Ladder) -> None:
    first = ladder.first.comparison
    page = story.of_comparison(first)
    assert [section.name for section in page.sections] == ["measured", "fails", "parameters", "provenance"]
    assert "leaves a test error of" in page.verdict.sentence


def test_an_adequate_model_is_called_so(folder: Path, ladder: Ladder) -> None:
    last = story.of_diagnosis(ladder.last)
    assert last.verdict.sentence == "The model coulomb-viscous+cogging+stribeck is adequate: " + (
        "nothing that could be predicted is left."
    )
    assert last.verdict.tone == "good"


@pytest.mark.long
def test_an_error_that_nothing_predicts_has_its_words(ladder: Ladder) -> None:
    from dataclasses import replace

    silent = story.of_diagnosis(replace(ladder.last, verdict="unknown-effect", view=None, findings=()))
    assert silent.verdict.tone == "bad"
    assert any("no recorded channel predicts it" in detail for detail in silent.verdict.details)


def test_a_linear_axis_has_forces_and_metres() -> None:
    from dataclasses import replace

    from fricmodels.dimension import Motion

    recording = replace(hidden().model_copy(update={"samples": 5_000}).simulate(), motion=Motion.LINEAR)
    train, test = kept_back(ready(recording))
    page = story.of_comparison(compare_model(train, test, Drive(Model.parse("coulomb-viscous"), None, Motion.LINEAR)))
    rows = {row[0]: row for row in cells(page)["coulomb-viscous"]}
    assert rows["K_v"][3] == "N s/m"
    assert rows["M"][3] == "kg"
    balance = next(block for block in blocks(page) if isinstance(block, Equations)).lines[0]
    assert balance[0].startswith("M·dω/dt")
    assert "Force over time" in [block.title for block in blocks(page) if isinstance(block, Picture)]


@pytest.mark.parametrize("content", [None, "{", '{"schema": "other"}', '{"schema": "fricmodels/diagnosis/1"}'])
def test_a_folder_without_results_is_refused_in_one_line(content: str | None, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "diagnosis.json").write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=str(tmp_path)):
        of_run(tmp_path)


def test_all_candidates_have_their_chance_beside_them_and_it_is_said_how_many_are_drawn(page: Page) -> None:
    picture = drawn(page, "candidates")
    assert picture.table is not None
    marks = [mark for trace in picture.figure.data for mark in zip(trace.y, trace.text, strict=True)]
    beside = {name: text.strip() for name, text in marks}
    assert "the best 8 are drawn" in picture.message
    assert len(beside) == 8
    for name, _, _, chance, passes in picture.table.rows[:8]:
        assert beside[name] == ("p < 10⁻⁶" if chance == "below one in a million" else f"p = {chance}")
        assert passes in ("yes", "no")
    passing = sum(row[-1] == "yes" for row in picture.table.rows)
    words = ("None", "One", "Two", "Three", "Four", "Five", "Six")
    assert f"{words[passing]} pass" in picture.message


def test_drawing_a_report_says_how_far_it_is(ladder: Ladder) -> None:
    told: list[Progress] = []
    with watched(told.append):
        story.of_ladder(ladder)
    parts = [(each.done, each.total) for each in told if each.stage == "drawing the report"]
    assert parts == [(done, 7) for done in range(7)]
    assert told[-1].left is not None


def test_warnings_of_the_log_check_stand_in_the_answer(ladder: Ladder, page: Page) -> None:
    assert "About the recording" not in dict(page.verdict.lines), "a note is no warning"
    data = document(ladder.first, ladder)
    lag = LogFinding(kind="velocity-lag", severity="warn", channel="velocity", text="it lags", remedy="")
    warned = data.model_copy(update={"recording": data.recording.model_copy(update={"findings": (lag,)})})
    lines = dict(story.verdict(warned).lines)
    assert lines["About the recording"] == "One warning: velocity-lag; the last section says what each means."
    assert [*lines][-1] == "What to do next", "its command follows"


def test_the_simulated_motion_stands_beside_the_measured_one(page: Page, ladder: Ladder) -> None:
    """Figure, caption and headline say the same, and the model with what was hidden moves as the drive did."""
    measured = next(section for section in page.sections if section.name == "measured")
    fold = measured.blocks[-1]
    assert isinstance(fold, Fold)
    headline = re.fullmatch(
        r"Simulated motion: the velocity is off by (\S+)\s% with what was found, by (\S+)\s% with the model as given",
        fold.title,
    )
    assert headline is not None
    last, first = (float(text) for text in headline.groups())
    assert last < first / 4
    picture = drawn(page, "simulated-motion")
    lines = {trace.name: np.asarray(trace.y, dtype=float) for trace in picture.figure.data}
    shown = lines["velocity simulated"] - lines["velocity measured"]
    np.testing.assert_allclose(lines["simulated − measured"], shown, atol=1e-5)
    assert f"({headline[1]}\xa0% of the RMS velocity)" in picture.message
    assert "with the model as given" in picture.message
    noise = re.search(r"noise of the sensors alone would give (\S+) rad/s", picture.message)
    error = re.search(r"RMS velocity error is (\S+) rad/s", picture.message)
    assert noise is not None
    assert error is not None
    assert 0 < float(noise[1]) <= 1.2 * float(error[1])
    assert "--score position" in getattr(fold.blocks[-1], "text", "")


def test_a_report_says_why_a_motion_is_not_simulated(ladder: Ladder) -> None:
    comparison = ladder.first.comparison
    estimate = comparison.estimate
    loose = replace(estimate, parameters={**estimate.parameters, "J": 0.0})
    drive = Drive(comparison.drive.model, None)
    words = simulated([replace(comparison, drive=drive, estimate=loose)])
    assert isinstance(words, Words)
    assert words.text == "The motion that the model would make is not simulated: the inertia is zero."


def test_of_more_than_two_figures_of_what_is_missing_all_effects_but_the_first_fold(ladder: Ladder) -> None:
    data = document(ladder.first, ladder)
    assert len(data.effects) == 2
    rest = data.model_copy(update={"remaining": Remaining.model_construct()})
    folded = [
        [
            block.title
            for block in found(each, []).blocks
            if isinstance(block, Fold) and block.title.startswith("stribeck")
        ]
        for each in (data, rest)
    ]
    assert folded[0] == []
    assert len(folded[1]) == 1
