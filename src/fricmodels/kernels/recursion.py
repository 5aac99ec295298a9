"""A recursion of first order along a series, compiled; `scipy.signal` would take longer to import than most fits."""

from __future__ import annotations

from typing import Any

from numba import njit


@njit(cache=True, nogil=True)
def first_order(series: Any, gain: float, factor: float, first: float, found: Any) -> None:
    """Write ``y[k] = gain * x[k] + factor * y[k - 1]``.

    Args:
        series: x, shape (N,).
        gain, factor: of what comes in, and of what was there.
        first: y before the first sample.
        found: y, to be written, shape (N,).
    """
    last = first
    for k in range(len(series)):
        last = gain * series[k] + factor * last
        found[k] = last
