"""What looking at reports on real drives has shown: axes, words and tables that contradicted each other."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis.comparison import Comparison, compare_model, kept_back
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report import figures, pictures, story
from fricmodels.report.captions import spectrum_words
from fricmodels.report.channels import channel_of_rest
from fricmodels.report.estimates import settling
from fricmodels.report.figures.style import logarithmic
from fricmodels.report.page import Block, Code, Fold, Gallery, Picture, Table
from fricmodels.results.diagnosis import Remaining
from fricmodels.results.history import Course, ParameterHistory
from fricmodels.results.words import of_motion, predictor
from fricmodels.weakform.prepared import ready

Made = Callable[..., Recording]


def compared(recording: Recording, inertia: float) -> Comparison:
    train, test = kept_back(ready(recording))
    return compare_model(train, test, Drive(Model.parse("coulomb-viscous"), inertia, recording.motion))


@pytest.fixture(scope="module")
def linear(made: Made) -> Comparison:
    return compared(made(motion=Motion.LINEAR), 2.0)


@pytest.mark.parametrize(
    ("predictor", "channel"),
    [
        ("motor torque, along the motion", "torque"),
        ("motor torque shortly before", "torque_rate"),
        ("rate of the motor torque", "torque_rate"),
        ("time, along the motion", "time"),
        ("load torque and direction", "load_torque"),
        ("distance since the last reversal", "distance since reversal"),
        ("j4 position, along the motion", "other.j4_position"),
        ("speed, along the motion", "velocity"),
        ("its own course shortly before", "velocity"),
    ],
)
def test_what_remains_is_shown_over_what_predicts_it(made: Made, predictor: str, channel: str) -> None:
    recording = made(samples=500)
    recording = recording.with_channels(**{"other.j4_position": recording["position"]})
    rest = Remaining(percent=9.0, SI=1.0, channel=predictor, where="", place=None, nearest=(), text="")
    assert channel_of_rest(rest, recording) == channel


def test_a_torque_is_a_force_on_a_linear_axis_and_names_stay() -> None:
    said = "Torque of poles; the RMS motor torques of torque-ripple in torque_Nm, positive rotation"
    expected = "Force of poles; the RMS motor forces of torque-ripple in torque_Nm, positive motion"
    assert of_motion(said, Motion.LINEAR) == expected
    assert of_motion(said, Motion.ROTARY) == said


def _words(blocks: list[Block]) -> list[str]:
    found: list[str] = []
    for block in blocks:
        match block:
            case Fold() | Gallery():
                found += _words([*block.blocks])
            case Picture():
                found += [block.title, block.message]
            case Table():
                found += [block.caption, *(each.title for each in block.columns)]
            case Code():
                pass
            case _:
                found.append(str(block))
    return found


def test_no_word_of_a_page_on_a_linear_axis_is_torque(linear: Comparison) -> None:
    page = story.of_comparison(linear)
    words = _words([block for section in page.sections for block in section.blocks])
    assert [text for text in words if text != of_motion(text, Motion.LINEAR)] == []
    assert any("force" in text for text in words)


def test_a_few_samples_far_off_do_not_flatten_the_rest_and_are_counted(linear: Comparison) -> None:
    assert figures.overlay(linear).layout.yaxis.range is None
    assert "beyond the axes" not in pictures.over_time(linear).message
    torque = linear.train.torque.copy()
    torque[1000] += 1e3
    train = linear.train.with_channels(torque=torque)
    spoilt = replace(linear, train=train)
    figure = figures.overlay(spoilt)
    low, high = figure.layout.yaxis2.range
    assert high - low < 100
    assert 1 <= figures.beyond_axes(figure) < 20
    assert re.search(r"[A-Z0-9]\w* samples? far off lies? beyond the axes\.", pictures.over_time(spoilt).message)


def test_the_table_of_a_coverage_is_one_of_times(linear: Comparison) -> None:
    table = pictures.covered(linear).table
    assert table is not None
    assert table.caption == "Mean time in a cell [s]"
    values = [float(cell) for column in table.columns[1:] for cell in column.cells if cell not in ("–",)]
    assert min(values) > 0


def test_a_spectrum_without_a_line_names_none(made: Made) -> None:
    words = spectrum_words(figures.residual_spectrum(compared(made(samples=4000), 1.8)))
    assert words.startswith("No line rises above") or " per turn" in words
    assert "1/turn" not in words


@pytest.mark.parametrize(("ends", "least"), [((2.0, 5.0), 4), ((0.2, 50.0), 6), ((1e-5, 10.0), 4)])
def test_a_logarithmic_axis_is_seen_to_be_one(ends: tuple[float, float], least: int) -> None:
    ticks = np.array(logarithmic(ends)["tickvals"])
    assert len(ticks) >= least
    assert 0.5 * ends[0] < ticks[0] < ticks[-1] < 2 * ends[1]


def test_a_channel_that_predicts_is_read_as_a_sentence() -> None:
    assert predictor("position, finely, along the motion") == (
        "position (with many waves, turning its sign with the motion)"
    )
    assert predictor("motor torque") == "motor torque"


def history(estimates: list[float], error: float | None = None) -> ParameterHistory:
    course = Course(unit="N m", estimates=tuple(estimates), final=estimates[-1], standard_error=error, truth=1.0)
    time = tuple(float(i) for i in range(len(estimates)))
    return ParameterHistory(
        model="coulomb-viscous", estimator="rls", dataset="a drive", kept=400, time=time, courses={"K_c": course}
    )


def test_a_history_shows_truth_and_final_value_and_how_many_are_drawn() -> None:
    figure = figures.parameter_history(history([0.0, 3.0, 0.9, 0.99, 1.0], 0.01))
    by_name = {trace.name: trace for trace in figure.data}
    assert set(by_name["true"].y) == {1.0}
    assert list(by_name["fit, 95 % interval"].y) == [1.0]
    assert by_name["fit, 95 % interval"].error_y.array[0] == pytest.approx(0.0196, rel=1e-3)
    assert dict(figure.layout.meta) == {"drawn": 5, "total": 400}


@pytest.mark.parametrize(
    ("estimates", "said"),
    [
        ([0.0, 3.0, 0.9, 0.99, 1.0, 1.0], "K_c settles last: from 3.00 s on"),
        ([0.0, 3.0, 0.2, 2.0, 0.3, 1.0], "K_c has not settled"),
    ],
)
def test_when_estimates_settle_is_computed(estimates: list[float], said: str) -> None:
    assert said in settling(history(estimates))
