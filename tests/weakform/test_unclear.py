"""Samples that are marked, and those beside them."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.weakform import cell_loops
from fricmodels.weakform.unclear import widened


@pytest.mark.parametrize("reach", [0, 1, 2, 3, 7, 40])
def test_marks_reach_so_far_and_no_farther(reach: int) -> None:
    rng = np.random.default_rng(0)
    for share in (0.0, 0.01, 0.3):
        mask = rng.random(200) < share
        marked = np.flatnonzero(mask)
        expected = [bool(len(marked)) and int(np.min(np.abs(marked - i))) <= reach for i in range(len(mask))]
        np.testing.assert_array_equal(widened(mask, reach), expected)
    assert widened(np.ones(1, dtype=bool), reach).tolist() == [True]


@pytest.mark.parametrize("seed", range(3))
def test_speeds_that_are_equal_but_for_last_digits_are_equal(seed: int) -> None:
    """A coarse sensor's speed falls from two steps to one: by as much as is left, which is near zero or is not."""
    rng = np.random.default_rng(seed)
    velocity = 0.6136 * rng.integers(1, 5, 400).astype(float)
    none, run = np.zeros(400), np.zeros(400, dtype=np.int64)

    def marked(velocity: np.ndarray) -> np.ndarray:
        found = np.empty(400, dtype=bool)
        cell_loops.hidden_turns(velocity, run, 0.01, none, none - 1.0, none + 1.0, found)
        return found

    exact = marked(velocity)
    assert 0 < np.count_nonzero(exact) < 400
    for change in (1e-12, 1e-7):
        assert np.array_equal(marked(velocity * (1 + change * rng.uniform(-1, 1, 400))), exact)
