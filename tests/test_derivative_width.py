"""The width over which counts are differentiated is near the best one, which needs the truth to be known."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from fricmodels.signals import noise_of


@pytest.mark.parametrize(
    ("rate", "bits", "fastest", "noise"),
    [
        (200, 12, 8.0, 0.0),
        (1000, 12, 1.0, 0.0),
        pytest.param(4000, 14, 8.0, 0.0, marks=pytest.mark.long),
        pytest.param(4000, 16, 8.0, 0.0, marks=pytest.mark.long),
        (4000, 12, 8.0, 0.5),
    ],
)
def test_it_is_near_the_best(
    from_benchmarks: Callable[[str], ModuleType], rate: int, bits: int, fastest: float, noise: float
) -> None:
    """With errors of steps averaged over the record, or a course that follows the steps, it was 2 to 9 times worse."""
    width = from_benchmarks("derivative_width")
    for seed in (3, 4):
        velocity = width.steps(seed, fastest)
        ratio, chosen, best = width.excess(*width.read_off(velocity, rate, bits, noise, seed))
        assert ratio < 1.4, (seed, chosen, best)


def test_nothing_is_joined_across_runs() -> None:
    """A run that begins where the other one did not end: no course leads from one to the other."""
    time = np.arange(4000) * 1e-3
    course = 0.3 * np.sin(2.0 * time)
    position, run = np.floor(course / 0.01) * 0.01, (time > 2.35).astype(np.int64)  # turns, and stays at one count
    noise = noise_of(time, position + 50.0 * run, run)
    assert noise.error is not None
    assert float(np.max(np.abs(noise.error))) < 1.5 * noise.step
