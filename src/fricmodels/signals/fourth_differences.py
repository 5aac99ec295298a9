r"""Fourth differences of means over some samples: what is left of a channel when every cubic is taken away.

The mean of a curve over instants :math:`t_j` is not the curve at their mean. So on uneven samples the five weights are
those under which the means of 1, t, t² and t³ over each of the five groups vanish together,

.. math:: \sum_{i=1}^{5} w_i\,\overline{t^k}_i = 0, \qquad k = 0 \dots 3,

which are divided differences where a group is one sample, and 1, −4, 6, −4, 1 where samples are even.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from fricmodels.arrays import Array
from fricmodels.signals.segments import is_even

DIFFERENCE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_SAMPLES = 1 << 14
"""Weights that are found at a time, so that memory stays bounded."""


def running_sums(time: Array, values: Array) -> tuple[Array | None, Array]:
    """Return the time stamps, ``None`` where they are even, and the sums up to each sample of values."""
    sums = np.zeros(len(values) + 1)
    np.cumsum(values - values.mean(), out=sums[1:])
    return None if is_even(time) else time, sums


def fourth_differences(time: Array | None, values: Array, scale: int) -> Array:
    """Return fourth differences of means over ``scale`` samples.

    On uneven samples they are scaled so that white noise is as large as on even ones; they need some hundred numbers a
    sample, and are taken some at a time.

    Args:
        time: time stamps of uneven samples [s], shape (N,).
        values: sums up to each sample, shape (N + 1,).
        scale: samples of a mean.
    """
    count, step = len(values) - 5 * scale, max(1, scale // 8)
    if time is not None:
        found = np.empty(len(range(0, count, step)))
        some = max(_SAMPLES // scale, _SAMPLES // 4)
        for start in range(0, len(found), some):
            rows = min(some, len(found) - start)
            first = start * step
            part = slice(first, first + (rows - 1) * step + 5 * scale)
            sums = values[part.start : part.stop + 1]
            found[start : start + rows] = _without_cubics(time[part], sums, scale, step)
        return found
    means = values[scale:] - values[:-scale]
    means /= scale
    at = [slice(k * scale, k * scale + count, step) for k in range(5)]
    found, other = means[at[0]] + means[at[4]], means[at[1]] + means[at[3]]
    other *= 4.0
    found -= other
    np.multiply(means[at[2]], 6.0, out=other)
    found += other
    return found


def _without_cubics(time: Array, sums: Array, scale: int, step: int) -> Array:
    """Return weighted means of five neighbouring groups, every ``step`` samples, shape (rows,).

    By divided differences of the moments of the groups: the difference of two neighbours is free of constants, that of
    two such, each over its slope, of slopes, and so on.
    """
    begins = np.arange(0, len(time) - scale + 1, step)
    apart = scale // step
    rows = len(begins) - 4 * apart
    first = time[begins]
    within = sliding_window_view(time, scale)[begins] - first[:, None]
    square = within * within
    one, two, three = within.mean(axis=1), square.mean(axis=1), (within * square).mean(axis=1)
    middle = first[2 * apart : 2 * apart + rows]
    size = first[4 * apart :] - first[:rows]
    means = (sums[begins + scale] - sums[begins]) / scale
    level = []
    for k in range(5):
        here = slice(k * apart, k * apart + rows)
        at = (first[here] - middle) / size
        a, b, c = one[here] / size, two[here] / size**2, three[here] / size**3
        weights = np.zeros((5, rows))
        weights[k] = 1.0
        moments = [at + a, at * (at + 2 * a) + b, at * (at * (at + 3 * a) + 3 * b) + c]
        level.append(np.concatenate([moments, means[here][None], weights]))
    while len(level) > 1:
        level = [after - before for before, after in pairwise(level)]
        if len(level) > 1:
            level = [each[1:] / each[0] for each in level]
    weights = level[0][-5:]
    return np.asarray(level[0][-6] * np.linalg.norm(DIFFERENCE) / np.sqrt(np.einsum("ij,ij->j", weights, weights)))
