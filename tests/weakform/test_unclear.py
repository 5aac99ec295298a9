"""Samples that are marked, and those beside them."""

from __future__ import annotations

import numpy as np
import pytest

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
