"""A clock that begins anew where its counter is full, or the day is over.

Microseconds in 32 bits are full after 71.6 minutes, milliseconds in 16 bits after 65.5 seconds.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array, Index

_BITS = (16, 24, 32)
_UNITS = (1.0, 1e-3, 1e-6)
"""A count of thousandths or millionths may have been written in seconds."""
_DAY = 86_400.0
_NEAR = 4.0
"""Usual intervals within which the last stamp lies below the end of the clock, and the next one above its beginning."""


def going_on(time: Array, run: Index) -> tuple[Array, float]:
    """Return stamps that go on where a clock began anew, shape (N,), and the period of the clock; 0 if it did not.

    Every step back within a run must lead from the very end of one clock to its very beginning. A run that was not
    named begins anew at any time.

    Args:
        time: stamps in the unit of the column, shape (N,).
        run: run number of each row, samples of each run together, shape (N,).
    """
    step = np.diff(time)
    within = np.diff(run) == 0
    back, forward = np.flatnonzero(within & (step < 0.0)), step[within & (step > 0.0)]
    if not len(back) or not len(forward):
        return time, 0.0
    near = _NEAR * float(np.median(forward))
    last, first = time[back], time[back + 1]
    for begin, period in _clocks():
        end = begin + period
        if np.all((last < end) & (last > end - near) & (first >= begin) & (first < begin + near)):
            begun = np.zeros(len(time))
            begun[back + 1] = 1.0
            times = np.cumsum(begun)
            times -= times[np.searchsorted(run, run)]  # each run counts its own
            return time + period * times, period
    return time, 0.0


def _clocks() -> Iterator[tuple[float, float]]:
    """Yield the least stamp of each clock that is known, and its period: counters with and without a sign, and days."""
    for unit in _UNITS:
        for bits in _BITS:
            period = 2.0**bits * unit
            yield from ((0.0, period), (-0.5 * period, period))
        yield 0.0, _DAY / unit
