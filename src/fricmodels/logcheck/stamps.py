"""Whether the time stamps are even, true and without gaps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.logcheck.balance import CLUSTERS
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.statistics import certain, clusters, slope
from fricmodels.logcheck.view import Log

_EVEN = 1e-3
"""Intervals that differ by a thousandth are even."""


def jitter(log: Log) -> float:
    """Return the standard deviation of the intervals over their median, gaps and lost samples aside."""
    interval = log.recording.interval
    regular = log.steps[log.joined & (log.steps < 1.5 * interval)]
    return float(np.std(regular)) / interval if len(regular) else 0.0


def gaps(log: Log) -> Iterator[Finding]:
    """Say where samples are missing: steps beyond the outer fence of all steps, five median steps at the least."""
    within = np.diff(log.recording.run) == 0
    long = log.steps[within & ~log.joined]
    if len(long):
        yield Finding(
            "gap",
            Severity.WARN,
            "time",
            f"{len(long)} gap{'s' if len(long) > 1 else ''} in time, the longest {1e3 * float(long.max()):.3g} ms, "
            f"{float(long.sum()):.3g} s in all; nothing connects what is on both sides",
        )


def truth(log: Log) -> Iterator[Finding]:
    r"""Judge whether uneven stamps are when the samples were taken.

    A sample is predicted from two on each side by the cubic of even samples. What that leaves over, D, is linear:

    .. math:: D x_i = \beta\,\dot x_i\,D t_i + \text{noise}

    with :math:`\beta = 1` where the stamps are true, and 0 where the samples were even and the stamps wander. The slope
    is taken from samples outside of those five, twice, six and eight samples away, of which the one is the instrument
    of the other, so that noise does not shrink β. False where β is below ½ at the level of
    :data:`~fricmodels.logcheck.statistics.LEVEL`, over 32 clusters. Where β cannot be told, the stamps' unevenness is
    lost in the channel's noise, and does no harm.
    """
    uneven = jitter(log)
    if uneven < _EVEN:
        return
    for channel in ("position", "velocity"):
        if channel not in log.measured:
            continue
        beta, error, count = _share(log.short, log.short.recording[channel])
        if certain((0.5 - beta) / error, count):
            yield Finding(
                "false-stamps",
                Severity.WARN,
                "time",
                f"the time stamps wander by {100 * uneven:.2g} % of the interval, but the {log.called(channel)} was "
                f"sampled evenly (the stamps explain {100 * max(beta, 0.0):.0f} % of what they claim)",
                "replace the stamps by even ones",
            )
            return
    yield Finding(
        "jitter",
        Severity.NOTE,
        "time",
        f"the intervals vary by {100 * uneven:.2g} % (standard deviation); they are taken as stamped",
    )


def _share(log: Log, values: Array) -> tuple[float, float, int]:
    time = log.recording.time
    size = len(time)
    breaks = np.r_[0, np.cumsum(~(log.joined & (log.steps < 1.5 * log.recording.interval)))]
    if size < 16 + 4 * CLUSTERS:
        return 0.5, np.inf, 1
    at = np.arange(8, size - 8)
    at = at[breaks[at + 8] == breaks[at - 8]]
    if len(at) < 4 * CLUSTERS:
        return 0.5, np.inf, 1
    left, uneven = (_left_by_cubic(x, at) for x in (values, time))
    near, far = ((values[at + m] - values[at - m]) / (time[at + m] - time[at - m]) * uneven for m in (6, 8))
    return slope(left, near, clusters(at, size, CLUSTERS), far)


def _left_by_cubic(x: Array, at: Index) -> Array:
    """Return what the cubic through two samples on each side leaves of the one between, all five being even."""
    return np.asarray(x[at] - (4.0 * (x[at - 1] + x[at + 1]) - x[at - 2] - x[at + 2]) / 6.0)
