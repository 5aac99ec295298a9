"""Standard errors that hold for autocorrelated residuals, and which parameters a recording does not determine."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.weakform.long_run import cosine_terms, long_run_sum

NORMAL_95 = 1.959963984540054
"""Standard errors that 95 % of a normal distribution lie within."""

_UNLIKELY = 0.01
"""Probability below which rows contradict a fit. The one that then stays is less certain, but as true."""
_IN_BLOCK, _FEWEST, _MOST = 8.0, 8, 24
"""Independent equations that a block of a jackknife has at least, and how many blocks there are."""


def is_contradicted(more: float, count: int, independent: float) -> bool:
    """Whether so much more than a fit leaves of its rows, as a share, is more than chance explains (F test at 1 %).

    Rows that are certain enough to tell a held torque are certain enough for that, too.

    Args:
        more: what another fit leaves of them, over what this one leaves, less 1.
        count: parameters of this one.
        independent: about how many of the rows are independent.
    """
    from scipy.special import fdtrc

    free = independent - count
    return free > 0.0 and bool(fdtrc(count, free, max(more, 0.0) * free / count) < _UNLIKELY)


def long_run_covariance(scores: Array, independent: float) -> tuple[Array, int]:
    """Return the long-run covariance matrix of a series of scores by equal-weighted cosines.

    Projects the series, shape (N, n), on the first ν cosines; the mean square of these projections is the spectrum at
    frequency zero (Lazarus, Lewis, Stock and Watson 2018, ν = 0.4 T^(2/3)). Holds without a model of the correlation.

    Args:
        scores: gradient of the squared error by parameter, one row for each equation.
        independent: T, about how many of the N rows are independent by construction.

    Returns:
        N × the long-run variance (the covariance of the sum of the scores), and ν.
    """
    terms = cosine_terms(independent, len(scores))
    return long_run_sum(np.ascontiguousarray(scores.T), terms), terms


def covariance(jacobian: Array, residual: Array, inverse: Array, independent: float) -> Array:
    """Return the covariance of least-squares estimates, robust to autocorrelation and unequal variance.

    It is widened so that ±1.96 standard errors cover 95 % although the variance rests on ν cosines only
    (Student's t with ν degrees of freedom in place of the normal distribution).

    Args:
        jacobian: derivative of the fitted values, shape (N, n).
        residual: shape (N,).
        inverse: (JᵀJ)⁻¹ of the part that is determined.
        independent: see :func:`long_run_covariance`.
    """
    from scipy.special import stdtrit

    meat, terms = long_run_covariance((jacobian.T * residual).T, independent)
    widen = float(stdtrit(terms, 0.975)) / NORMAL_95
    by_cosines = widen**2 * inverse @ meat @ inverse
    by_blocks = jackknife_covariance(jacobian, residual, inverse, independent)
    return at_least(by_cosines, by_blocks)


def covariance_once(jacobian: Array, residual: Array, inverse: Array, independent: float, parts: Index) -> Array | None:
    """Return :func:`covariance` by cosines where a motion repeats, with what repeats counted once.

    What a model gets wrong is the same in each repetition: scores at the same phase are added before their variance is
    estimated. ``None`` where a period has too few rows to tell anything.

    Args:
        jacobian, residual, inverse, independent: see :func:`covariance`.
        parts: in which part of what repeats each equation lies, numbered without gaps, shape (N,).
    """
    from scipy.special import stdtrit

    count = int(parts.max(initial=-1)) + 1
    if count < jacobian.shape[1] + _FEWEST:
        return None
    scores = np.empty((count, jacobian.shape[1]))  # of no column where every parameter is held
    for j, column in enumerate(jacobian.T * residual):
        scores[:, j] = np.bincount(parts, column, count)
    meat, terms = long_run_covariance(scores, independent * count / len(residual))
    widen = float(stdtrit(terms, 0.975)) / NORMAL_95
    return np.asarray(widen**2 * inverse @ meat @ inverse)


def at_least(matrix: Array, other: Array) -> Array:
    """Return a covariance whose variances are the larger ones of two, with the correlations of the first."""
    before, wanted = (np.clip(np.diag(each), 0.0, None) for each in (matrix, other))
    grown = np.sqrt(np.maximum(np.divide(wanted, before, out=np.ones_like(wanted), where=before > 0.0), 1.0))
    return np.asarray(matrix * np.outer(grown, grown))


def jackknife_covariance(
    jacobian: Array, residual: Array, inverse: Array, independent: float, blocks: int | None = None
) -> Array:
    r"""Return the covariance of least-squares estimates by leaving out one block of equations after the other.

    .. math:: V = \frac{G-1}{G} \sum_g (\theta_{(g)} - \bar\theta)(\theta_{(g)} - \bar\theta)^T, \qquad
              \theta_{(g)} - \theta = -(X^TX - X_g^TX_g)^{-1} X_g^T e_g

    What is left of the equations is less than their error where few of them decide, as those at reversals do: they are
    fitted. A block that is left out is not.

    Without a block that alone determines a direction nothing is known of it, and the estimate goes anywhere. At least
    one block's share of what all know is taken to be left. Nor does such a block tell how well it determines it: a
    friction that few equations after a jump show fits them, whatever their error is. There the error is taken to be
    what it is all over the record: a variance of its long run, in directions in which all that is known is one.

    Source: A. C. Cameron, D. L. Miller, "A practitioner's guide to cluster-robust inference", J. Human Resources 50
    (2015), CR3.

    Args:
        jacobian, residual, inverse, independent: see :func:`covariance`.
        blocks: how many blocks of equally many equations there are; as many as are independent if not given.
    """
    from scipy.special import stdtrit

    from fricmodels.kernels.small import products_of_blocks

    size = np.sqrt(np.einsum("ij,ij->j", jacobian, jacobian))
    size = np.where(size > 0.0, size, 1.0)
    inverse = inverse * np.outer(size, size)
    blocks = blocks or int(min(max(independent / _IN_BLOCK, _FEWEST), _MOST))
    edges = np.linspace(0, len(residual), blocks + 1).astype(int)
    value, vector = np.linalg.eigh(inverse)
    root = vector * np.sqrt(np.clip(value, 0.0, None))
    rows = (root / size[:, None]).T @ jacobian.T
    # (A − A_g)⁻¹ s = R (1 − RᵀA_gR)⁻¹ Rᵀs with A⁻¹ = RRᵀ: by the share of what is known that the block holds.
    shares, scores = np.empty((blocks, len(root), len(root))), np.empty((blocks, len(root)))
    products_of_blocks(rows, residual, edges, shares, scores)
    decisive = np.trace(shares, axis1=1, axis2=2) > 1.0 - 1.0 / blocks  # else each share is less, too
    along, alone = np.empty_like(scores), np.zeros((0, len(root)))
    along[~decisive] = np.linalg.solve(np.eye(len(root)) - shares[~decisive], scores[~decisive, :, None])[:, :, 0]
    if decisive.any():
        share, direction = np.linalg.eigh(shares[decisive])
        left = np.maximum(1.0 - share, 1.0 / blocks)
        turned = (scores[decisive, None] @ direction)[:, 0] / left
        along[decisive] = (direction @ turned[:, :, None])[:, :, 0]
        alone = direction.transpose(0, 2, 1)[share > 1.0 - 1.0 / blocks] @ root.T / size
    moved = along @ root.T
    apart = (moved - np.mean(moved, axis=0)) / size
    widen = float(stdtrit(blocks - 1, 0.975)) / NORMAL_95
    found = widen**2 * (blocks - 1) / blocks * apart.T @ apart
    if len(alone):
        everywhere, _ = long_run_covariance(residual[:, None], independent)
        found = at_least(found, float(everywhere[0, 0]) / len(residual) * alone.T @ alone)
    return np.asarray(found)
