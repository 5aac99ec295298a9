"""Drives with two waves of a kind, and others that only look so."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.comparison import numbered


@pytest.fixture(scope="module")
def benchmark(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    """Return the module that makes such drives."""
    return from_benchmarks("two_gears")


KINDS = [
    pytest.param(("cogging", "cogging"), marks=pytest.mark.long),  # three of them: tests/diagnosis/test_supported.py
    pytest.param(("position-friction", "position-friction"), marks=pytest.mark.long),
]


@pytest.mark.parametrize("names", KINDS)
def test_both_are_named_with_their_wave_numbers(benchmark: ModuleType, names: tuple[str, str]) -> None:
    """Before, the second was given the name of another effect."""
    outcome = benchmark.judged(benchmark.trial(names, 500))
    assert outcome.found == 2
    assert outcome.others == ()


def test_what_is_left_of_a_kind_is_numbered_from_the_first_on(benchmark: ModuleType) -> None:
    """A ladder may take away the first of two; that the other one was the second says nothing then."""
    recording = benchmark.trial(("cogging", "position-friction"), 500, samples=3000).recording
    second = compare(recording, "coulomb-viscous+position-friction+cogging(2)", 2.0)
    first = numbered(second)
    assert first.drive.model.name == "coulomb-viscous+position-friction+cogging"
    assert first.estimate.parameters["cogging.k"] == pytest.approx(second.estimate.parameters["cogging(2).k"], rel=1e-4)
    assert numbered(first) is first
