"""Uninterrupted stretches of a recording: within one run, without a gap in time."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fricmodels.arrays import Array, Index

Runs = Index

_FENCE = 3.0
"""Tukey's outer fence, in interquartile ranges."""
_BRIDGED = 5.0
"""Steps of up to so many median steps are no gap: a local polynomial over true time stamps bridges lost samples."""


def gap_length(time: Array, runs: Runs | None = None) -> float:
    """Return the step [s] from which the samples on both sides belong to different stretches.

    The outer fence of the logarithm of the steps, for steps that vary by nature, and never less than five median steps.
    """
    step = np.diff(time)
    if runs is not None:
        step = step[np.diff(runs) == 0]
    step = step[step > 0]
    if not len(step):
        return float("inf")
    low, middle, high = np.percentile(step, [25.0, 50.0, 75.0])
    return float(max(high * (high / low) ** _FENCE, _BRIDGED * middle))


def stretches(time: Array, runs: Runs | None = None) -> list[slice]:
    """Return the uninterrupted stretches, in order; together they are all samples."""
    if not len(time):
        return []
    step = np.diff(time)
    new = np.zeros(len(step), dtype=bool) if runs is None else runs[1:] != runs[:-1]
    within = step[~new] if new.any() else step
    # Where no step is as long as five others no gap is, and the fence need not be found.
    if len(within) and not 0.0 < _BRIDGED * within.min() > within.max():
        new |= step >= gap_length(time, runs)
    inner = (np.flatnonzero(new) + 1).tolist() if new.any() else []
    return [slice(start, stop) for start, stop in pairwise([0, *inner, len(time)])]


def is_even(time: Array) -> bool:
    """Whether the samples are evenly spaced, as far as a thousandth of a step."""
    if len(time) < 3:
        return True
    step = (time[-1] - time[0]) / (len(time) - 1)
    apart = np.arange(float(len(time)))
    apart *= step
    apart += time[0]
    np.subtract(time, apart, out=apart)
    return bool(np.abs(apart, out=apart).max() <= 1e-3 * step)
