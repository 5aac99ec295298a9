"""Passages near zero speed of which the samples do not show the course."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.weakform import split


@pytest.mark.parametrize("seed", range(3))
def test_speeds_that_are_equal_but_for_last_digits_are_equal(seed: int) -> None:
    """A coarse sensor's speed falls from two steps to one: by as much as is left, which is near zero or is not."""
    rng = np.random.default_rng(seed)
    velocity = 0.6136 * rng.integers(1, 5, 400).astype(float)
    none, run = np.zeros(400), np.zeros(400, dtype=np.int64)

    def marked(velocity: np.ndarray) -> np.ndarray:
        found = np.empty(400, dtype=bool)
        split.hidden_turns(velocity, run, 0.01, none, none - 1.0, none + 1.0, found)
        return found

    exact = marked(velocity)
    assert 0 < np.count_nonzero(exact) < 400
    for change in (1e-12, 1e-7):
        assert np.array_equal(marked(velocity * (1 + change * rng.uniform(-1, 1, 400))), exact)
