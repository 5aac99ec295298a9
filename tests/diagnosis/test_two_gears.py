"""Drives with two waves of a kind, and others that only look so."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def benchmark(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    """Return the module that makes such drives."""
    return from_benchmarks("two_gears")


@pytest.mark.parametrize("names", [("cogging", "cogging"), ("position-friction", "position-friction")])
def test_both_are_named_with_their_wave_numbers(benchmark: ModuleType, names: tuple[str, str]) -> None:
    """Before, the second was given the name of another effect."""
    outcome = benchmark.judged(benchmark.trial(names, 500))
    assert outcome.found == 2
    assert outcome.others == ()
