"""What is left of means over some samples when every cubic is taken away, on even and on uneven samples."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.signals import noise_of
from fricmodels.signals.fourth_differences import DIFFERENCE, fourth_differences, running_sums

SCALES = (1, 2, 3, 8, 24, 96)


def uneven(samples: int, seed: int = 0) -> np.ndarray:
    """Return instants of a log that keeps every fifth sample of a clock of 1 ms by chance."""
    return 1e-3 * np.sort(np.random.default_rng(seed).choice(5 * samples, samples, replace=False))


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("evenly", [True, False])
def test_a_cubic_leaves_nothing_and_white_noise_what_it_leaves_on_even_samples(scale: int, evenly: bool) -> None:
    time = 5e-3 * np.arange(12_000) if evenly else uneven(12_000)
    x = time / 60.0
    cubic = fourth_differences(*running_sums(time, 3.0 + x - 2.0 * x**2 + x**3), scale)
    assert np.abs(cubic).max() < 1e-9
    noise = np.random.default_rng(1).standard_normal(len(time))
    left = fourth_differences(*running_sums(time, noise), scale)
    expected = np.linalg.norm(DIFFERENCE) / np.sqrt(scale)
    assert np.std(left) == pytest.approx(expected, rel=0.25 if scale > 20 else 0.05)


@pytest.mark.parametrize("scale", SCALES)
def test_uneven_samples_that_hardly_are_tell_the_same_as_even_ones(scale: int) -> None:
    time = 5e-3 * np.arange(12_000)
    jittered = time + 2e-5 * np.random.default_rng(2).uniform(-1, 1, len(time))
    noise = np.random.default_rng(1).standard_normal(len(time))
    one, other = (fourth_differences(*running_sums(t, noise), scale) for t in (time, jittered))
    assert len(one) == len(other)
    assert np.abs(one - other).max() < 0.05 * np.std(one)


@pytest.mark.parametrize("seed", range(4))
def test_the_noise_of_a_fast_motion_that_was_sampled_at_random(seed: int) -> None:
    """The mean of a curve over instants is not the curve at their mean: it was taken for motion, the noise for none."""
    time = uneven(12_000, seed)
    position = 0.4 * np.sin(2 * time) + 2e-6 * np.random.default_rng(seed).standard_normal(len(time))
    assert noise_of(time, position).deviation == pytest.approx(2e-6, rel=0.05)
