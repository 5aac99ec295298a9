"""What a series that remembers adds up to: the variance of its sum, without a model of how it remembers.

The series is projected on the first ν cosines, and the mean square of these projections is its spectrum at frequency
zero (Lazarus, Lewis, Stock and Watson 2018, ν = 0.4 T^(2/3)).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmodels.arrays import Array

FEWEST_TERMS = 8
"""Cosines that a variance is estimated by at the least."""

_WITHIN, _POWERS, _SHORTEST_BLOCK = 0.5, 14, 8
"""Phase by which a cosine may move from the middle of a block to its end, the powers that then reach the last digit
(0.5^14/14! = 7e-16), and samples of a block with which that is less work than a transform."""


def cosine_terms(independent: float, rows: int) -> int:
    """Return the number ν of cosines for T independent rows: 0.4 T^(2/3), at least 8, fewer than rows."""
    most = max(rows - 1, 1)
    return int(min(max(round(0.4 * independent ** (2 / 3)), min(FEWEST_TERMS, most)), most))


def long_run_sum(series: Array, terms: int) -> Array:
    """Return the covariance of the sums over time of n series, shape (n, N) → (n, n), by ν cosines of equal weight."""
    projected = first_cosines(series, terms)
    return np.asarray(series.shape[1] / terms * (projected @ projected.T))


def first_cosines(series: Array, terms: int) -> Array:
    r"""Return the projections of series on the first cosines, without the constant, shape (n, terms).

    .. math:: c_k = \sqrt{2/N} \sum_i x_i \cos\bigl(\pi k (i + \tfrac12)/N\bigr), \qquad k = 1 \dots \nu

    Few cosines are slow: within a block of samples each is a power series about the middle, of so many terms that the
    next one is below rounding. So the cosines are needed at the blocks only, and nothing hangs on the factors of N.

    Args:
        series: shape (n, N).
        terms: ν, less than N.
    """
    from scipy.fft import dct

    count = series.shape[1]
    block = int(_WITHIN * 2.0 * count / (np.pi * terms))
    if block < _SHORTEST_BLOCK:
        return np.asarray(dct(series, type=2, norm="ortho")[:, 1 : terms + 1])
    blocks = -(-count // block)
    padded = np.zeros((len(series), blocks * block))
    padded[:, :count] = series
    powers, cosines, sines = _about_the_middles(count, terms, block)
    moments = (padded.reshape(-1, block) @ powers).reshape(len(series), blocks, _POWERS).transpose(0, 2, 1)
    found = np.einsum("ijk,jk->ik", moments[:, 0::2] @ cosines[0], cosines[1])
    found -= np.einsum("ijk,jk->ik", moments[:, 1::2] @ sines[0], sines[1])
    return np.asarray(found)


@lru_cache(maxsize=8)
def _about_the_middles(count: int, terms: int, block: int) -> tuple[Array, tuple[Array, Array], tuple[Array, Array]]:
    """Return what :func:`first_cosines` needs of so many samples in blocks.

    That is powers of the place in a block, shape (block, powers), and for the even and the odd powers: the cosines or
    sines at the middle of each block, shape (blocks, terms), and factors, shape (powers / 2, terms).
    """
    step = np.pi / count * np.arange(1, terms + 1)  # of the phase, from sample to sample
    apart = np.arange(block) - 0.5 * (block - 1)
    powers = np.ones((block, _POWERS))
    scales = np.full((_POWERS, terms), np.sqrt(2.0 / count))
    for j in range(1, _POWERS):
        powers[:, j] = powers[:, j - 1] * apart / block
        scales[j] = scales[j - 1] * step * block / j * (-1.0 if j % 2 == 0 else 1.0)
    phase = np.outer(block * np.arange(-(-count // block)) + 0.5 * block, step)
    return powers, (np.cos(phase), scales[0::2]), (np.sin(phase), scales[1::2])
