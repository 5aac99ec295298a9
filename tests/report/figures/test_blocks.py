"""What a figure finds block by block, so that memory stays bounded, is what it was in one piece, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array, Index
from fricmodels.report.figures import against
from fricmodels.report.figures.against import Means, means
from fricmodels.report.figures.residuals import Pieces, correlation_length
from fricmodels.report.figures.samples import Samples


def in_one_piece(x: Array, values: Array, other: Array, piece: Index, edges: Array) -> Means:
    place = np.searchsorted(edges, x, side="right") - 1
    inside = (place >= 0) & (place < len(edges) - 1)
    place, size = place[inside], len(edges) - 1
    count = np.bincount(place, minlength=size)
    mean = np.bincount(place, values[inside], size) / np.maximum(count, 1)
    rest = values[inside] - mean[place]
    deviation = np.sqrt(np.bincount(place, rest**2, size) / np.maximum(count, 1))
    half = 1.959964 * deviation / np.sqrt(np.maximum(count / correlation_length(rest, piece[inside]), 1.0))
    second = np.bincount(place, other[inside], size) / np.maximum(count, 1)
    shown = count >= 8
    return Means(((edges[:-1] + edges[1:]) / 2)[shown], mean[shown], half[shown], second[shown])


@pytest.mark.parametrize("block", [97, 1000, 1 << 17])
def test_means_in_bins(block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(3)
    values = np.convolve(rng.standard_normal(5019), np.ones(20), "valid")
    x, other, piece = rng.standard_normal(5000), rng.standard_normal(5000), np.repeat([0, 1, 2], [700, 3100, 1200])
    edges = np.linspace(-2.0, 2.0, 12)  # some samples lie beyond
    monkeypatch.setattr(against, "_BLOCK", block)
    found, expected = means(x, values, other, piece, edges), in_one_piece(x, values, other, piece, edges)
    for name in ("at", "mean", "half", "other"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), strict=True)


@pytest.mark.parametrize("channel", ["velocity", "position", against.TORQUE_RATE, against.SINCE_REVERSAL])
def test_errors_over_a_channel(channel, rotary, monkeypatch) -> None:
    whole = against.error_over(rotary, channel, period=0.5)
    monkeypatch.setattr(against, "_BLOCK", 211)
    blocks = against.error_over(rotary, channel, period=0.5)
    assert blocks.opposes == whole.opposes
    for name in ("at", "mean", "half", "other"):
        np.testing.assert_array_equal(getattr(blocks.before, name), getattr(whole.before, name))


@pytest.mark.parametrize("sizes", [[5], [2, 3, 1], [3, 3], [1, 4, 4]])
def test_the_longest_piece(sizes: list[int]) -> None:
    piece = np.repeat(np.arange(len(sizes)) + 7, sizes)
    longest = int(np.argmax(sizes))
    for step in (1, 2, 100):
        pieces = Pieces()
        for start in range(0, len(piece), step):
            pieces.follow(piece[start : start + step])
        begin = sum(sizes[:longest])
        assert pieces.beginning_of_longest() == slice(begin, begin + sizes[longest])


def test_two_parts_are_the_whole_again_without_a_copy(rotary) -> None:
    samples, whole = Samples.of(rotary), rotary.train.origin.whole
    for name in ("time", "torque", "velocity"):
        assert samples.recording[name] is whole[name]
    both = samples.joined.in_order(rotary.train.time, rotary.test.time)
    np.testing.assert_array_equal(both, whole.time)
    assert np.count_nonzero(samples.kept_back) == len(rotary.test)
