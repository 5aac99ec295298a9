"""Projections on the first cosines, by power series in blocks: the same as by a transform."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.fft import dct

from fricmodels.weakform.long_run import first_cosines


@pytest.mark.parametrize(("count", "terms"), [(20, 19), (400, 20), (997, 25), (4983, 46), (9973, 74), (10000, 8)])
def test_they_are_those_of_a_transform(count: int, terms: int) -> None:
    series = np.cumsum(np.random.default_rng(count).standard_normal((3, count)), axis=1)
    expected = dct(series, type=2, norm="ortho")[:, 1 : terms + 1]
    assert first_cosines(series, terms) == pytest.approx(expected, rel=0.0, abs=1e-13 * np.max(np.abs(expected)))
