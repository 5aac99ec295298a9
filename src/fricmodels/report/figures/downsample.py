"""Thins a long signal to what a screen can show, without losing a peak."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmodels.arrays import Array, Index
from fricmodels.report.figures.style import POINTS


def extremes(x: Array, values: Array, points: int = POINTS) -> Index:
    """Return the indices of the least and the greatest value in each of ``points / 2 - 1`` even buckets of x.

    A line through them covers the same pixels as one through all samples.

    Args:
        x: not decreasing, shape (N,).
        values: shape (N,); what is not a number is left out.
        points: most indices that are returned; at least 4.
    """
    count = len(x)
    if count <= points:
        return np.arange(count)
    buckets = points // 2 - 1
    if x[-1] > x[0]:
        starts = np.searchsorted(x, np.linspace(x[0], x[-1], buckets, endpoint=False))
    else:
        starts = np.linspace(0, count, buckets, endpoint=False).astype(np.int64)
    starts = np.unique(starts)
    stops = np.append(starts[1:], count)
    chosen = [np.array([0, count - 1])]
    for least_or_greatest in (np.fmin, np.fmax):
        extreme = least_or_greatest.reduceat(values, starts)
        hits = np.flatnonzero(values == np.repeat(extreme, stops - starts))
        first = np.append(hits, count)[np.searchsorted(hits, starts)]
        chosen.append(first[first < stops])
    return np.unique(np.concatenate(chosen))


@dataclass(frozen=True)
class Together:
    """Several signals at the same samples; where their pieces are not connected there is a NaN in each.

    Attributes:
        x: where the samples lie.
        values: of each signal at them.
        drawn: how many samples that are.
    """

    x: Array
    values: tuple[NDArray[np.float32], ...]
    drawn: int


def together(x: Array, signals: Sequence[Array], piece: Index) -> Together:
    """Return signals at the same at most 2000 samples, among them the extremes of each.

    Signals that are thinned apart would differ where they do not.

    Args:
        x: not decreasing, shape (N,).
        signals: shape (N,) each.
        piece: number of the piece of each sample; see :func:`line`.
    """
    breaks = _breaks(piece, POINTS)
    room = POINTS - len(breaks)
    if len(x) <= room:
        index = np.arange(len(x))
    else:
        index = np.unique(np.concatenate([extremes(x, each, room // len(signals)) for each in signals]))
    at = np.searchsorted(index, breaks, side="right")
    at = at[(at > 0) & (at < len(index))]
    lines = tuple(np.insert(each[index].astype(np.float32), at, np.float32(np.nan)) for each in signals)
    return Together(np.insert(x[index], at, x[index][at - 1]), lines, len(index))


def _breaks(piece: Index, points: int) -> Index:
    """Return after which samples a piece ends; none where there are more than can be told apart."""
    breaks = np.flatnonzero(np.diff(piece))
    return breaks if len(breaks) <= points // 4 else breaks[:0]


@dataclass(frozen=True)
class Line:
    """A thinned line; where its pieces are not connected there is a NaN in y."""

    x: Array
    y: NDArray[np.float32]


def line(x: Array, values: Array, piece: Index | None = None, points: int = POINTS) -> Line:
    """Return a line of at most ``points`` points through a signal, with its peaks, interrupted between pieces.

    Args:
        x: not decreasing, shape (N,).
        values: shape (N,).
        piece: number of the piece of each sample; where there are more pieces than can be told apart, all is joined.
        points: most points.
    """
    breaks = np.array([], dtype=np.int64) if piece is None else _breaks(piece, points)
    index = extremes(x, values, points - len(breaks))
    at = np.searchsorted(index, breaks, side="right")
    across = (at > 0) & (at < len(index))
    shown_x, shown_y = x[index], values[index].astype(np.float32)
    return Line(
        np.insert(shown_x, at[across], shown_x[at[across] - 1]), np.insert(shown_y, at[across], np.float32(np.nan))
    )
