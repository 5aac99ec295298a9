"""Sums over a window about each sample, compiled: as arrays, each window would be held once for every power."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

_BLOCK = 512
"""Windows that are averaged together, side by side in the cache."""


@njit(cache=True, nogil=True)
def window_moments(time: Any, values: Any, size: int, at: Any, scale: Any, moments: Any, right: Any) -> None:
    r"""Add up the powers of the time, and their products with a signal, in the window about each sample.

    With :math:`x_j = (t_j - t_i) / s_i` these are :math:`\sum_j x_j^k` and :math:`\sum_j x_j^k (y_j - y_i)`.

    Args:
        time, values: t and y, shape (N,).
        size: samples of a window, at most N; at the ends it stays within the samples, one-sided.
        at: the samples i, shape (n,).
        scale: s, to be written: the greatest distance in the window, shape (n,).
        moments: zeros to be added to, shape (n, powers).
        right: likewise with the signal, for no more powers than there are moments, shape (n, powers).
    """
    count = len(time)
    both, every = right.shape[1], moments.shape[1]
    for i in range(len(at)):
        centre = at[i]
        first = min(max(centre - size // 2, 0), count - size)
        now, here = time[centre], values[centre]
        scale[i] = max(now - time[first], time[first + size - 1] - now)
        shrink = 1.0 / scale[i]
        for j in range(first, first + size):
            x, y, power = (time[j] - now) * shrink, values[j] - here, 1.0
            for k in range(both):
                moments[i, k] += power
                right[i, k] += power * y
                power *= x
            for k in range(both, every):
                moments[i, k] += power
                power *= x


@njit(cache=True, nogil=True)
def window_means(time: Any, errors: Any, width: int, means: Any) -> None:
    r"""Write the means of errors of intervals in the window about each sample, by Lanczos's weights.

    .. math:: c_{ij} \propto \Delta t_j\,\max\bigl(r_i^2 - (t_{j+1/2} - t_i)^2, 0\bigr), \qquad
              r_i = (w + \tfrac12)\,\overline{\Delta t}_i

    Sums are taken in the same order on every processor, those of neighbouring samples side by side.

    Args:
        time: shape (N,).
        errors: of each interval, shape (k, N − 1).
        width: w, intervals on either side of a sample.
        means: to be written, of each sample that has so many on either side, shape (k, N − 2 w).
    """
    step, middle = np.empty(len(time) - 1), np.empty(len(time) - 1)
    for j in range(len(step)):
        step[j], middle[j] = time[j + 1] - time[j], 0.5 * (time[j] + time[j + 1])
    reach, whole, weight = np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK)
    for start in range(0, means.shape[1], _BLOCK):
        count = min(_BLOCK, means.shape[1] - start)
        centre = time[start + width : start + width + count]
        for i in range(count):
            reach[i] = whole[i] = 0.0
        for offset in range(2 * width):
            steps = step[start + offset : start + offset + count]
            for i in range(count):
                reach[i] += steps[i]
        for i in range(count):
            mean = reach[i] / (2 * width)
            reach[i] = ((width + 0.5) * mean) ** 2
        for k in range(len(errors)):
            found = means[k, start : start + count]
            for i in range(count):
                found[i] = 0.0
        for offset in range(2 * width):
            begin, end = start + offset, start + offset + count
            steps, middles = step[begin:end], middle[begin:end]
            for i in range(count):
                apart = middles[i] - centre[i]
                weight[i] = steps[i] * max(reach[i] - apart * apart, 0.0)
                whole[i] += weight[i]
            for k in range(len(errors)):
                error, found = errors[k, begin:end], means[k, start : start + count]
                for i in range(count):
                    found[i] += weight[i] * error[i]
        for k in range(len(errors)):
            found = means[k, start : start + count]
            for i in range(count):
                found[i] /= whole[i]
