"""Uninterrupted stretches of a recording: within one run, without a gap in time."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from fricmodels.arrays import Array, Index, Mask

Runs = Index

_FENCE = 3.0
"""Tukey's outer fence, in interquartile ranges."""
BRIDGED = 5.5
"""Steps below so many median steps are no gap: a local polynomial over true time stamps bridges four lost samples.
Not a whole number, so that no rounding of stamps decides."""
_FEW = 20
"""Steps of a run below which its usual one is that of all runs."""


def usual_steps(time: Array, runs: Runs | None = None) -> Array:
    """Return the median step [s] of the run that each step lies in, shape (N − 1,): each may have a rate of its own."""
    return _of_each_run(time, runs, lambda step: float(np.median(step)))


def gap_lengths(time: Array, runs: Runs | None = None) -> Array:
    """Return from which step [s] on the samples on both sides are of different stretches, at each, shape (N − 1,).

    The outer fence of the logarithm of the steps of a run, for steps that vary by nature, and never less than five
    median ones.
    """
    return _of_each_run(time, runs, _gap_length)


def _gap_length(step: Array) -> float:
    step = step[step > 0]
    if not len(step):
        return float("inf")
    low, middle, high = np.percentile(step, [25.0, 50.0, 75.0])
    return float(max(high * (high / low) ** _FENCE, BRIDGED * middle))


def _of_each_run(time: Array, runs: Runs | None, number: Callable[[Array], float]) -> Array:
    """Return a number of the steps of each run at all of them, shape (N − 1,); of all steps where a run has few."""
    step = np.diff(time)
    within = np.ones(len(step), dtype=bool) if runs is None else runs[1:] == runs[:-1]
    borders = [0, *(np.flatnonzero(~within) + 1).tolist(), len(time)]
    if len(borders) == 2:
        return np.full(len(step), number(step) if len(step) else np.nan)
    inside = step[within]
    found = np.full(len(step), number(inside) if len(inside) else np.nan)
    for start, stop in pairwise(borders):
        if stop - start > _FEW:
            found[start : stop - 1] = number(step[start : stop - 1])
    return found


def joined(time: Array, runs: Runs) -> Mask:
    """Return whether a sample and the next one belong together: one run, no gap between; shape (N − 1,)."""
    return np.asarray((np.diff(runs) == 0) & (np.diff(time) < gap_lengths(time, runs)))


def stretches(time: Array, runs: Runs | None = None) -> list[slice]:
    """Return the uninterrupted stretches, in order; together they are all samples."""
    if not len(time):
        return []
    step = np.diff(time)
    new = np.zeros(len(step), dtype=bool) if runs is None else runs[1:] != runs[:-1]
    within = step[~new] if new.any() else step
    # Where no step is as long as five others no gap is, and the fence need not be found.
    if len(within) and not 0.0 < BRIDGED * within.min() > within.max():
        new |= step >= gap_lengths(time, runs)
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
