"""The kinds of NumPy arrays that annotations name, and what is asked of masks."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""Numbers."""

Mask: TypeAlias = NDArray[np.bool_]
"""Which samples."""

Index: TypeAlias = NDArray[np.int64]
"""Places of samples, or run numbers."""


def widened(mask: Mask, reach: int) -> Mask:
    """Mark also the ``reach`` samples before and after each marked one."""
    near, done = mask.copy(), 0
    while done < reach and done < len(mask):
        step, before = min(done + 1, reach - done), near.copy()
        near[step:] |= before[:-step]
        near[:-step] |= before[step:]
        done += step
    return near


def deviations(covariance: Array) -> Array:
    """Return the standard deviations of a covariance; zero where rounding makes a variance negative."""
    return np.asarray(np.sqrt(np.clip(np.diag(covariance), 0.0, None)))


def rms(values: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
