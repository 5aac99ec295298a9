"""Slopes and tests over clusters of a record, and the level at which a finding is sure."""

from __future__ import annotations

import math

import numpy as np

from fricmodels.arrays import Array, Index

LEVEL = 1e-6
"""Chance of a false finding in one test. There are some twenty tests, so that one recording in fifty thousand is
accused where their assumptions hold; they hold roughly, hence a level that leaves room."""

PROBABLE = 1e-4
"""Chance of a false finding in a test that only warns."""


def significance(ratio: float, clusters: int) -> float:
    """Return the one-sided p value of |estimate / error| by Student's t of ``clusters`` − 1."""
    from scipy.special import stdtr

    return float(stdtr(max(clusters - 1, 1), -abs(ratio))) if math.isfinite(ratio) else 0.0


def certain(ratio: float, clusters: int) -> bool:
    """Whether an estimate is positive at :data:`LEVEL`, given its ratio to its error."""
    return ratio > 0.0 and significance(ratio, clusters) < LEVEL


def slope(y: Array, x: Array, cluster: Index, instrument: Array | None = None) -> tuple[float, float, int]:
    """Return the slope of y on x through zero, its standard error over clusters, and the number of clusters.

    With an instrument z the slope is Σzy / Σzx, which noise in x does not bias if z does not share it.
    """
    z = x if instrument is None else instrument
    below = float(z @ x)
    if below == 0.0:
        return 0.0, math.inf, 1
    value = float(z @ y) / below
    sums = np.bincount(cluster, z * (y - value * x))
    count = int(np.count_nonzero(np.bincount(cluster)))
    if count < 2:
        return value, math.inf, count
    return value, float(np.sqrt(sums @ sums * count / (count - 1))) / abs(below), count


def clusters(start: Index, size: int, count: int) -> Index:
    """Return the number, from 0 without gaps, of the equal part of the record in which each row begins."""
    return np.asarray(np.unique(start * count // max(size, 1), return_inverse=True)[1])
