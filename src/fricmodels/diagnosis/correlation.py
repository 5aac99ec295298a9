"""How the estimates of a model's parameters are correlated."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.comparison import Comparison


def correlation(comparison: Comparison) -> tuple[tuple[str, ...], Array] | None:
    """Return the keys of what was estimated and the correlation of each with each; ``None`` where it is not known.

    What stands at its bound, or is not determined, has none and is left out.
    """
    estimate = comparison.estimate
    if estimate.covariance is None:
        return None
    own = estimate.own_errors
    spread = np.sqrt(np.maximum(np.diag(estimate.covariance), 0.0))
    kept = (spread > 0) & (np.array([own[key] for key in own]) > 0)
    keys = tuple(key for key, used in zip(own, kept, strict=True) if used)
    matrix = estimate.covariance[np.ix_(kept, kept)] / np.outer(spread[kept], spread[kept])
    return keys, np.clip(matrix, -1.0, 1.0)
