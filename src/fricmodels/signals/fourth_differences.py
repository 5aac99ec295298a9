"""Fourth differences of means over some samples: what is left of a channel when every cubic is taken away."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.signals.segments import is_even

DIFFERENCE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_SAMPLES = 1 << 16
"""Divided differences that are taken at a time, so that memory stays bounded."""


def running_sums(time: Array, values: Array) -> tuple[Array | None, Array]:
    """Return the sums up to each sample of time stamps, ``None`` where they are even, and of values."""
    return None if is_even(time) else _sums_of(time - time[0]), _sums_of(values - values.mean())


def _sums_of(values: Array) -> Array:
    sums = np.zeros(len(values) + 1)
    np.cumsum(values, out=sums[1:])
    return sums


def fourth_differences(time: Array | None, values: Array, scale: int) -> Array:
    """Return fourth differences of means over ``scale`` samples, from sums up to each sample.

    On uneven samples they are divided differences, scaled so that white noise is as large as on even ones; they need
    fifty numbers a sample, and are taken some at a time.
    """
    count, step = len(values) - 5 * scale, max(1, scale // 8)
    if time is not None:
        found = np.empty(len(range(0, count, step)))
        for start in range(0, len(found), _SAMPLES):
            first, last = start * step, min(start + _SAMPLES, len(found)) * step
            part = slice(first, min(last, count) + 5 * scale)
            found[start : start + _SAMPLES] = _divided_differences(time[part], values[part], scale, step)
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


def _divided_differences(time: Array, values: Array, scale: int, step: int) -> Array:
    count = len(values) - 5 * scale
    at = [slice(k * scale, k * scale + count, step) for k in range(5)]
    means, instants = ((sums[scale:] - sums[:-scale]) / scale for sums in (values, time))
    places = np.stack([instants[part] for part in at])
    apart = places[:, None] - places[None]
    apart[np.arange(5), np.arange(5)] = 1.0
    weights = 1.0 / apart.prod(axis=1)
    weights *= np.linalg.norm(DIFFERENCE) / np.linalg.norm(weights, axis=0)
    return np.asarray(np.einsum("ij,ij->j", weights, np.stack([means[part] for part in at])))
