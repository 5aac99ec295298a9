"""The story in the terminal: everything that the document says, at any width, with or without colour."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from tests.conftest import Demonstration

from fricmodels.diagnosis import Ladder, compare, diagnose
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.present import show_comparison, show_diagnosis, show_ladder
from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.results.words import LEAST_NOISE, chance_text, share_text
from fricmodels.rig import write
from fricmodels.rig.demonstration import hidden

Made = Callable[..., Recording]


@pytest.fixture(scope="module")
def ladder(demonstration: Demonstration) -> Ladder:
    return demonstration.ladder


def printed(ladder: Ladder, width: int, encoding: str = "utf-8", **options: Any) -> str:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding, errors="replace")
    console = Console(file=stream, width=width, **options)
    show_comparison(console, ladder.first.comparison)
    show_diagnosis(console, ladder.first, ladder)
    show_ladder(console, ladder)
    stream.seek(0)
    return stream.read()


def numbers(value: object, where: str = "") -> Iterator[tuple[str, float]]:
    """Yield every number of a document with its place."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from numbers(item, f"{where}.{key}")
    elif isinstance(value, list):
        for number, item in enumerate(value):
            yield from numbers(item, f"{where}[{number}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield where, float(value)


def ways_to_print(value: float, where: str = "") -> set[str]:
    """Return a number in two to five figures and as percentage; what means nothing as its bound."""
    if where.endswith("p_value"):
        return {chance_text(value).removeprefix("< ")}
    if "share_of" in where or where.endswith("held_out_gain"):
        return {share_text(value).removeprefix("< ").removesuffix(" %")}
    if where.endswith(("noise_floor_percent", "fit_noise_percent")) and value < LEAST_NOISE:
        return {f"{LEAST_NOISE}"}
    if where.endswith("recording.interval"):  # printed in ms
        return {f"{1000 * value:.3g}"}
    least = 1 if "parameters" in where else 2  # a parameter has the figures that its standard error bears
    return {f"{value:.{digits}g}" for digits in range(least, 6)}


@pytest.mark.parametrize("width", [60, 80, 120])
def test_every_number_of_the_document_is_printed_whole(ladder: Ladder, width: int) -> None:
    text = printed(ladder, width)
    words = {word.strip("(),.;:") for word in text.split()}
    listed = list(numbers(document(ladder.first, ladder).plain()))
    assert len(listed) > 100
    missing = [(where, value) for where, value in listed if not ways_to_print(value, where) & words]
    assert not [place for place in missing if not (place[0].startswith(".ladder") and place[1] == 0)]
    assert "…" not in text


@pytest.mark.parametrize("width", [60, 80, 120])
def test_lines_are_no_wider_than_the_terminal_and_plain(ladder: Ladder, width: int) -> None:
    text = printed(ladder, width)
    assert max(len(line) for line in text.splitlines()) <= width
    assert "\x1b" not in text


def test_colour_adds_nothing_that_the_text_does_not_say(ladder: Ladder) -> None:
    import re

    coloured = printed(ladder, 80, force_terminal=True, color_system="truecolor")
    assert "\x1b" in coloured
    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured) == printed(ladder, 80)


def test_a_terminal_of_plain_ascii_gets_bars_and_plots_too(ladder: Ladder) -> None:
    text = printed(ladder, 80, encoding="ascii")
    assert "####" in text
    assert "o modelled" in text


def test_the_story_names_what_was_found_and_what_could_not_be_seen(ladder: Ladder) -> None:
    text = " ".join(printed(ladder, 80).split())
    assert "'cogging' is missing" in text
    assert "τ = a·cos kq + b·sin kq" in text
    for step, name in ((0, "coulomb-viscous"), (1, "with cogging"), (2, "with stribeck")):
        assert f"{step} {name} " in text
    assert "the recording has no temperature" in text


def test_a_linear_axis_is_shown_in_its_units(made: Made) -> None:
    stream = io.StringIO()
    console = Console(file=stream, width=80)
    show_comparison(console, compare(made(motion=Motion.LINEAR), "coulomb-viscous"))
    text = stream.getvalue()
    assert "velocity [m/s]" in text
    assert "[N]" in text
    assert "N m" not in text
    assert "kg" in text


def test_a_model_may_be_given_by_name_or_as_it_is(made: Made) -> None:
    recording = made(samples=4000)
    by_name, as_it_is = (
        diagnose(recording, "coulomb-viscous", 2.0),
        diagnose(recording, Model.parse("coulomb-viscous"), 2.0),
    )
    assert document(by_name) == document(as_it_is)
    assert by_name.comparison.errors == compare(recording, "coulomb-viscous", 2.0).errors


@pytest.mark.long
@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_a_pipe_gets_plain_text_of_its_width(encoding: str, tmp_path: Path) -> None:
    rig = hidden().model_copy(update={"samples": 1500})
    data, _ = write(rig.simulate(), tmp_path / "joint.csv")
    command = [sys.executable, "-m", "fricmodels", "diagnose", data.name, "--model", "coulomb-viscous"]
    environment = {**os.environ, "COLUMNS": "72", "PYTHONIOENCODING": encoding}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, timeout=120, check=True)
    text = done.stdout.decode(encoding)
    assert b"\x1b" not in done.stdout + done.stderr
    assert max(len(line) for line in text.splitlines()) <= 72
    assert "Verdict" in text
