"""The spectrum of a signal over position: at which wave numbers it is periodic along the path, not in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmodels.arrays import Array

Complex = NDArray[np.complex128]

PEAKS = 12
"""Most wave numbers that are returned."""
LEAST_PERIODS = 1.0
"""A period is told from slower shapes once the positions cover it."""
MOST_BINS = 2**15
"""Bins of the positions."""
PADDING = 4
"""Times as many as the positions fill, so that the spectrum is fine."""


@dataclass(frozen=True)
class WaveNumbers:
    """Wave numbers at which something is periodic in position.

    Attributes:
        strongest: wave numbers [1/rad or 1/m] of the highest peaks, the highest first; empty where none can be told.
        resolution: π over the range of position; closer ones are not told apart.
        independent: how many independent ones were looked at.
        height: of the highest peak.
    """

    strongest: tuple[float, ...]
    resolution: float
    independent: float
    height: float = 0.0

    def and_faster(self, other: WaveNumbers) -> WaveNumbers:
        """Return these and faster ones that were looked at besides."""
        strongest, independent = (*other.strongest, *self.strongest), self.independent + other.independent
        return WaveNumbers(strongest, self.resolution, independent, max(self.height, other.height))


def wave_numbers(position: Array, weights: Array, fastest: float, least: float = 0.0) -> WaveNumbers:
    r"""Return where :math:`|\sum_i w_i e^{-\mathrm{j} k q_i}|` peaks over the wave number k.

    The weights are summed over even bins of position, and one Fourier transform over position, padded with zeros,
    shows every wave number at once; a period need not divide a turn.

    Args:
        position: q at each sample [rad or m], shape (N,).
        weights: w at each sample, shape (N,).
        fastest: greatest wave number to look at.
        least: smallest one; never below one period in the range of position.
    """
    low, span = float(np.min(position)), float(np.ptp(position))
    slowest = max(LEAST_PERIODS * 2 * np.pi / span, least) if span > 0 else np.inf
    if not fastest > slowest:
        return WaveNumbers((), np.pi / span if span > 0 else 1.0, 1.0)
    k, lines = spectrum(position - low, weights, span, min(MOST_BINS, binned(fastest, span)))
    power = np.abs(lines) ** 2
    inside = (k >= slowest) & (k <= fastest)
    peaks = np.flatnonzero(inside[1:-1] & (power[1:-1] >= power[:-2]) & (power[1:-1] >= power[2:])) + 1
    edges = np.flatnonzero(inside)[[0, -1]] if np.any(inside) else np.array([], dtype=int)
    peaks = np.unique(np.concatenate([peaks, edges]))
    strongest = peaks[np.argsort(power[peaks])[::-1][:PEAKS]]
    independent = max(1.0, float((min(fastest, k[-1]) - slowest) * span / np.pi))
    height = float(np.max(power[strongest], initial=0.0))
    return WaveNumbers(tuple(float(k[i]) for i in strongest), float(np.pi / span), independent, height)


def binned(fastest: float, span: float) -> int:
    """Return how many bins of position show waves up to a wave number: four to the shortest, a power of two."""
    return int(max(64, 2 ** np.ceil(np.log2(4 * fastest * span / (2 * np.pi)))))


def spectrum(position: Array, weights: Array, span: float, bins: int) -> tuple[Array, Complex]:
    r"""Return wave numbers, shape (K,), and there :math:`\sum_i w_i e^{-\mathrm{j} k q_i}`, shape (K,).

    Args:
        position: q at each sample, from 0 to the span.
        weights: w at each sample.
        span: range of position.
        bins: even bins of position over which the weights are summed.
    """
    place = np.minimum((position / span * bins).astype(np.int64), bins - 1)
    summed = np.bincount(place, weights=weights, minlength=bins)
    lines = np.fft.rfft(summed, PADDING * bins)
    return np.asarray(2 * np.pi / (span * PADDING) * np.arange(len(lines)), dtype=float), lines
