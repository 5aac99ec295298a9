"""Whether rows that reach over a reversal agree with those that do not.

Friction is evaluated at a velocity that was smoothed. At a reversal the slope of the velocity jumps, and smoothing
rounds that off: the instant of the reversal, and all that goes with a low speed, is wrong by more than noise makes it.
That error is the same in every recording of its kind, and standard errors do not see it. Rows that no reversal and no
sample about one lies in do not have it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fricmodels.arrays import Index, Mask, deviations
from fricmodels.weakform.solve import Solved, solve

_LEAST = 0.5
"""Share of the rows that must be clear of reversals."""
_HALF = 0.5
"""Ratio of standard errors below which a fit is far more certain than another."""
_DISAGREES = 0.1
"""Probability below which the two fits are said to disagree. A fit without bias is worth more than an efficient one."""


def clear_of_reversals(found: Solved, left: Callable[[Solved], float]) -> Solved:
    """Return the fit to the rows clear of reversals, where it is far more certain than that to all rows, or differs.

    The fit to all rows stays where too few are clear, and where nothing speaks against it. What only rows at reversals
    tell may be there, or explain no more than their error: the fit that leaves less of the whole recording is taken.

    Args:
        found: the fit to all rows, at a smoothed velocity.
        left: sum of squares that a fit leaves of the whole recording.
    """
    problem = found.problem
    reach = problem.recording.derived_over + problem.half_width
    clear = problem.clear_of(_about(problem.quadrature.cell, reach, len(problem.recording)))
    if clear.rows == problem.rows or clear.rows < _LEAST * problem.rows:
        return found
    other = solve(clear, found.plan, timing=found.timing)
    if len(other.solution.normal.null.T) > len(found.solution.normal.null.T) + 1:  # no reversal is left to be shifted
        return min(found, other, key=left)
    return other if _is_far_more_certain(other, found) or _disagree(found, other) else found


def _about(cell: Index, reach: int, count: int) -> Mask:
    """Mark the samples that are no farther than so many from the first one of some cells, shape (count,)."""
    begin, end = np.maximum(cell - reach, 0), np.minimum(cell + reach + 1, count)
    marks = np.bincount(begin, minlength=count + 1) - np.bincount(end, minlength=count + 1)
    return np.asarray(np.cumsum(marks[:-1]) > 0)


def _is_far_more_certain(one: Solved, other: Solved) -> bool:
    """Whether the standard errors of one fit are less than half of another's, in the geometric mean.

    Fewer rows that seem a little more certain are so by chance.
    """
    variances = [np.diag(fit.covariance) for fit in (one, other)]
    free = variances[0] > 0.0
    if not np.array_equal(free, variances[1] > 0.0):
        return False
    size = np.sqrt(variances[0][free])
    scaled = [fit.covariance[np.ix_(free, free)] / size / size[:, None] for fit in (one, other)]
    first, second = (np.linalg.slogdet(part) for part in scaled)
    least = 2.0 * len(size) * np.log(_HALF)
    return bool(first.sign > 0 and second.sign > 0 and first.logabsdet - second.logabsdet < least)


def _disagree(found: Solved, other: Solved) -> bool:
    """Whether two fits differ by more than the error of the one to fewer rows explains (Hausman 1978)."""
    from scipy.special import chdtrc

    apart, spread = found.values - other.values, other.covariance
    size = deviations(spread)
    free = size > 0.0
    if not free.any():
        return False
    scaled = spread[np.ix_(free, free)] / np.outer(size[free], size[free])
    unit = apart[free] / size[free]
    statistic = float(unit @ np.linalg.pinv(scaled, rcond=1e-10, hermitian=True) @ unit)
    return bool(chdtrc(int(free.sum()), statistic) < _DISAGREES)
