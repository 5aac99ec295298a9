"""Sums over a window about each sample, compiled: as arrays, each window would be held once for every power."""

from __future__ import annotations

from typing import Any

from numba import njit


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
