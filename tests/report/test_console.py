"""The answer in a terminal: short, first and last the verdict, no wider than the terminal, plain where it is piped."""

from __future__ import annotations

import io
from typing import Any

import pytest
from rich.console import Console

from fricmodels.cli.printing import progress_line
from fricmodels.diagnosis import Ladder
from fricmodels.report.console import show_answer_of_comparison, show_answer_of_diagnosis, show_answer_of_ladder


@pytest.fixture
def ladder(demonstration: Any) -> Ladder:
    return demonstration.ladder


def printed(ladder: Ladder, what: str, width: int = 80, encoding: str = "utf-8") -> str:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding, errors="strict")
    console = Console(file=stream, width=width)
    if what == "improve":
        show_answer_of_ladder(console, ladder)
    elif what == "diagnose":
        show_answer_of_diagnosis(console, ladder.first)
    else:
        show_answer_of_comparison(console, ladder.first.comparison)
    stream.seek(0)
    return stream.read()


@pytest.mark.parametrize("what", ["improve", "diagnose", "compare"])
def test_the_answer_is_short_and_comes_first_and_last(ladder: Ladder, what: str) -> None:
    lines = printed(ladder, what).rstrip().splitlines()
    assert len(lines) <= 42
    if what == "compare":
        assert "test error of 1" in lines[0]
        return
    assert lines[0].endswith("The model coulomb-viscous lacks two effects: cogging and stribeck.")
    assert "poles, slots" in lines[1]
    assert lines[-1].startswith("Verdict: missing-effect: cogging and stribeck; test error 1")


@pytest.mark.parametrize("width", [60, 80, 120])
def test_no_line_but_a_command_is_wider_than_the_terminal(ladder: Ladder, width: int) -> None:
    for what in ("improve", "diagnose", "compare"):
        for line in printed(ladder, what, width).splitlines():
            assert len(line) <= width or line.startswith("  fricmodels "), line
            assert "\N{REPLACEMENT CHARACTER}" not in line
            assert "\N{NO-BREAK SPACE}" not in line


def test_a_terminal_of_ascii_can_print_the_answer(ladder: Ladder) -> None:
    """Every sign of the sentences has one in ASCII; names and figures are not lost."""
    text = printed(ladder, "diagnose", encoding="ascii")
    assert "o mean error   + what cogging adds" in text
    assert "cogging" in text


def test_diagnose_ranks_the_runner_up_and_does_not_repeat_compare(ladder: Ladder) -> None:
    text = printed(ladder, "diagnose")
    assert "The best of 19 candidates, each by itself" in text
    assert text.index("cogging  ") < text.index("rising-stiction")
    assert "Parameters" not in text
    assert "fricmodels improve" in text


def test_improve_prints_the_model_to_use(ladder: Ladder) -> None:
    text = printed(ladder, "improve")
    assert "Parameters of coulomb-viscous+cogging+stribeck" in text
    assert "with cogging" in text
    assert "docs/hidden_effects.md" in text
    assert "Next: Use the model." in text


def test_progress_of_a_tournament_has_rate_and_time_left() -> None:
    assert progress_line(40, 120, 3.9) == "40 of 120 fits, 3.9/s, 21 s left"
