r"""Lanczos's differentiator by local least squares, for even and uneven sampling.

Around each sample a polynomial is fitted to the 2h + 1 nearest samples; its value and slope there are the smoothed
signal and its derivative. With a polynomial of degree 2 on an even grid the slope is Lanczos's low-noise derivative

.. math:: \dot y_i = \frac{3 \sum_{k=1}^{h} k\,(y_{i+k} - y_{i-k})}{h(h+1)(2h+1)\,\Delta t}.

At the borders of a stretch the window stays within it, one-sided.

Source: C. Lanczos, *Applied Analysis* (1956), ch. 5; A. Savitzky and M. Golay, Anal. Chem. 36 (1964) 1627.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.signals.segments import Runs, is_even, stretches

DEGREE = 2
_BLOCK = 1 << 16
"""Windows that are fitted at once, so that memory stays bounded."""
_FEW = 48
"""Weights with which a direct convolution is the faster one."""
_BLOCKS = 8
"""Samples of a block that is transformed, in weights of a filter."""
_AT_ONCE = 1 << 18
"""Samples that are convolved at a time, so that memory stays bounded."""


def lanczos_derivative(time: Array, values: Array, half_width: int, runs: Runs | None = None) -> tuple[Array, Array]:
    """Return the smoothed signal and its derivative by time.

    Args:
        time: sample times [s], increasing within each run, shape (N,).
        values: the signal, shape (N,).
        half_width: h; :func:`fricmodels.signals.best_half_width` finds it from the noise.
        runs: run of each sample; windows never reach over runs or gaps.
    """
    values = np.asarray(values, dtype=float)
    smooth, slope = np.empty_like(values), np.empty_like(values)
    for part in stretches(time, runs):
        smooth[part], slope[part] = fit_stretch(time[part], values[part], half_width)
    return smooth, slope


def lanczos_value(time: Array, values: Array, half_width: int, runs: Runs | None = None, *, order: int = 0) -> Array:
    """Return the smoothed signal, or its derivative by time where the order is 1: half of :func:`lanczos_derivative`.

    Args:
        time, values, half_width, runs: as there.
        order: 0 or 1.
    """
    values = np.asarray(values, dtype=float)
    found = np.empty_like(values)
    for part in stretches(time, runs):
        found[part] = _fitted(time[part], values[part], half_width, (order,))[0]
    return found


def fit_stretch(time: Array, values: Array, half_width: int) -> tuple[Array, Array]:
    """Return value and slope of the local polynomials in one uninterrupted stretch."""
    smooth, slope = _fitted(time, values, half_width, (0, 1))
    return smooth, slope


def _fitted(time: Array, values: Array, half_width: int, orders: tuple[int, ...]) -> list[Array]:
    size = min(2 * half_width + 1, len(time))
    degree = min(DEGREE, size - 1)
    if degree == 0:
        return [np.zeros_like(values) if order else values.copy() for order in orders]
    if not (is_even(time) and len(time) > 2 * size):
        both = _fit_windows(time, values, size, degree, np.arange(len(time)))
        return [both[order] for order in orders]
    step = (time[-1] - time[0]) / (len(time) - 1)
    weights, mean = even_weights(half_width, degree), values.mean()
    centred, found = values - mean, []
    basis, at_window = _even_window(half_width, degree)
    first, last = basis @ centred[:size], basis @ centred[-size:]
    for order in orders:
        unit = step if order else 1.0
        inside = _convolved(centred, weights[order][::-1] / unit)
        inside[:half_width] = at_window[order, :half_width] @ first / unit
        inside[-half_width:] = at_window[order, -half_width:] @ last / unit
        if not order:
            inside += mean
        found.append(inside)
    return found


def _convolved(values: Array, weights: Array) -> Array:
    """Return the convolution at every sample, directly with few weights, by transforms of blocks with many."""
    if len(weights) <= _FEW:
        return np.convolve(values, weights, mode="same")
    found, reach = np.empty(len(values)), len(weights) // 2
    for start in range(0, len(values), _AT_ONCE):
        before = max(start - reach, 0)
        part = _transformed(values[before : start + _AT_ONCE + reach], weights)
        found[start : start + _AT_ONCE] = part[start - before : start - before + _AT_ONCE]
    return found


def _transformed(values: Array, weights: Array) -> Array:
    """Return the convolution at every sample by transforms of blocks that overlap, added up."""
    from scipy.fft import irfft, next_fast_len, rfft  # all of scipy.signal takes longer to import than most fits

    more, first = len(weights) - 1, (len(weights) - 1) // 2
    size = next_fast_len(_BLOCKS * more, real=True)
    step = size - more
    blocks = -(-len(values) // step)
    padded = np.zeros((blocks + 1, step))
    padded.reshape(-1)[: len(values)] = values
    parts = irfft(rfft(padded[:-1], size) * rfft(weights, size), size)
    padded[:-1], padded[-1] = parts[:, :step], 0.0
    padded[1:, :more] += parts[:, step:]
    return np.asarray(padded.reshape(-1)[first : first + len(values)])


@lru_cache(maxsize=1024)
def even_weights(half_width: int, degree: int = DEGREE) -> tuple[Array, Array]:
    """Return the weights of value and slope at the centre of 2h + 1 evenly spaced samples a unit apart, read-only."""
    offset = np.arange(-half_width, half_width + 1) / max(half_width, 1)
    degree = min(degree, 2 * half_width)
    weights = np.linalg.pinv(np.vander(offset, degree + 1, increasing=True))
    value, slope = weights[0], weights[1] / max(half_width, 1)
    value.flags.writeable = slope.flags.writeable = False
    return value, slope


@lru_cache(maxsize=1024)
def _even_window(half_width: int, degree: int) -> tuple[Array, Array]:
    """Return what a polynomial through 2h + 1 evenly spaced samples needs, read-only.

    That is what gives its coefficients, shape (degree + 1, 2h + 1), and what gives its value and slope at each of the
    samples from these, shape (2, 2h + 1, degree + 1).
    """
    offset = np.arange(-half_width, half_width + 1) / half_width
    powers = np.vander(offset, degree + 1, increasing=True)
    basis = np.asarray(np.linalg.pinv(powers), dtype=float)
    slopes = np.zeros_like(powers)
    slopes[:, 1:] = powers[:, :-1] * np.arange(1, degree + 1) / half_width
    both = np.array([powers, slopes])
    both.flags.writeable = basis.flags.writeable = False
    return basis, both


def _fit_windows(time: Array, values: Array, size: int, degree: int, at: Index) -> tuple[Array, Array]:
    """Fit at the samples ``at`` by normal equations, each window scaled to [−1, 1] about its sample."""
    from fricmodels.kernels.windows import window_moments

    smooth, slope = np.empty(len(at)), np.empty(len(at))
    time, values = np.ascontiguousarray(time, dtype=float), np.ascontiguousarray(values, dtype=float)
    for start in range(0, len(at), _BLOCK):
        centre = at[start : start + _BLOCK]
        scale = np.empty(len(centre))
        moments, right = np.zeros((len(centre), 2 * degree + 1)), np.zeros((len(centre), degree + 1))
        window_moments(time, values, size, centre, scale, moments, right)
        normal = moments[:, np.add.outer(np.arange(degree + 1), np.arange(degree + 1))]
        coefficients = np.linalg.solve(normal, right[:, :, None])[:, :, 0]
        smooth[start : start + _BLOCK] = coefficients[:, 0] + values[centre]
        slope[start : start + _BLOCK] = coefficients[:, 1] / scale
    return smooth, slope


def lanczos_window(half_width: int) -> Array:
    """Return Lanczos's symmetric window ``sinc(k/(h+1))``, k = −h … h, of sum 1: the paper's pre-filter."""
    weights = np.sinc(np.arange(-half_width, half_width + 1) / (half_width + 1))
    normalised: Array = weights / weights.sum()
    return normalised


def lanczos_smooth(time: Array, values: Array, half_width: int, runs: Runs | None = None) -> Array:
    """Smooth with a symmetric Lanczos window; at the borders of a stretch the window shrinks, and stays symmetric."""
    result = np.array(values, dtype=float)
    for part in stretches(time, runs):
        count = part.stop - part.start
        signal = np.asarray(values[part], dtype=float)
        if count > 2 * half_width:
            inner = slice(part.start + half_width, part.stop - half_width)
            result[inner] = np.convolve(signal, lanczos_window(half_width), mode="valid")
        for near in range(min(half_width, (count + 1) // 2)):
            window = lanczos_window(near)
            result[part.start + near] = window @ signal[: 2 * near + 1]
            result[part.stop - 1 - near] = window @ signal[count - 2 * near - 1 :]
    return result
