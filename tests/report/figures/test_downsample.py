"""Thinning keeps every peak, is bounded, and is quick."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fricmodels.report.figures import extremes, line


@given(
    arrays(np.float64, st.integers(1, 3000), elements=st.floats(-1e6, 1e6)),
    st.integers(4, 400),
    st.integers(0, 2**32 - 1),
)
def test_extremes_first_and_last_are_kept(values, points, seed):
    x = np.sort(np.random.default_rng(seed).uniform(size=len(values)))
    index = extremes(x, values, points)
    assert len(index) <= points
    assert np.all(np.diff(index) > 0)
    assert index[0] == 0
    assert index[-1] == len(values) - 1
    assert values[index].max() == values.max()
    assert values[index].min() == values.min()


def test_one_sample_out_of_two_million_is_seen_within_a_fifth_of_a_second():
    count = 2_000_000
    x, values = np.arange(count) * 1e-3, np.sin(np.arange(count) * 1e-2)
    values[1_234_567] = 5.0
    values[765_432] = -5.0
    began = time.process_time()
    thin = line(x, values)
    seconds = time.process_time() - began
    assert len(thin.x) <= 2000
    assert thin.y.max() == 5.0
    assert thin.x[np.argmax(thin.y)] == x[1_234_567]
    assert thin.y.min() == -5.0
    assert seconds < 0.2


def test_every_bucket_keeps_its_own_extremes():
    x = np.arange(10_000.0)
    values = np.random.default_rng(1).standard_normal(10_000)
    shown = values[extremes(x, values, 202)]
    edges = np.linspace(0, 10_000, 101).astype(int)
    for a, b in pairwise(edges):
        assert values[a:b].max() in shown
        assert values[a:b].min() in shown


def test_a_line_is_interrupted_between_pieces_and_nowhere_else():
    x = np.arange(9000.0)
    piece = np.repeat([0, 1, 2], 3000)
    thin = line(x, np.ones(9000), piece, 300)
    gaps = np.flatnonzero(np.isnan(thin.y))
    assert len(gaps) == 2
    assert len(thin.x) <= 300
    for gap, border in zip(gaps, (3000, 6000), strict=True):
        assert thin.x[gap - 1] < border <= thin.x[gap + 1]


def test_what_is_not_a_number_is_left_out():
    values = np.full(5000, np.nan)
    values[77] = 3.0
    index = extremes(np.arange(5000.0), values, 100)
    assert 77 in index
