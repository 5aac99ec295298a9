"""Even cells that never mix what is negative with what is positive."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array


def even_edges(low: float, high: float, cells: int) -> Array:
    """Return the borders of at most ``cells`` even cells from ``low`` to ``high``; where zero lies between, it is one.

    Friction jumps where the velocity changes its sign: a cell with samples of both directions would show neither.
    """
    if not high > low:
        low, high = low - 0.5, high + 0.5
    if not low < 0 < high:
        return np.linspace(low, high, cells + 1)
    width = (high - low) / (cells - 1)
    below = int(np.clip(np.ceil(-low / width), 1, cells - 1))
    return np.asarray(np.arange(-below, cells - below + 1) * max(-low / below, high / (cells - below)), dtype=float)
