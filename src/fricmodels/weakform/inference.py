"""Standard errors that hold for autocorrelated residuals, and which parameters a recording does not determine."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_IN_BLOCK, _FEWEST, _MOST = 8.0, 8, 24
"""Independent equations that a block of a jackknife has at least, and how many blocks there are."""


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
    from scipy.fft import dct

    count = len(scores)
    terms = int(np.clip(round(0.4 * independent ** (2 / 3)), min(8, max(count - 1, 1)), max(count - 1, 1)))
    projected = dct(np.ascontiguousarray(scores.T), type=2, norm="ortho")[:, 1 : terms + 1].T
    return count * (projected.T @ projected) / terms, terms


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

    meat, terms = long_run_covariance(jacobian * residual[:, None], independent)
    widen = float(stdtrit(terms, 0.975)) / 1.959963984540054
    by_cosines = widen**2 * inverse @ meat @ inverse
    by_blocks = jackknife_covariance(jacobian, residual, inverse, independent)
    before, other = (np.clip(np.diag(each), 0.0, None) for each in (by_cosines, by_blocks))
    grown = np.sqrt(np.maximum(np.divide(other, before, out=np.ones_like(other), where=before > 0.0), 1.0))
    return np.asarray(by_cosines * np.outer(grown, grown))


def jackknife_covariance(
    jacobian: Array, residual: Array, inverse: Array, independent: float, blocks: int | None = None
) -> Array:
    r"""Return the covariance of least-squares estimates by leaving out one block of equations after the other.

    .. math:: V = \frac{G-1}{G} \sum_g (\theta_{(g)} - \bar\theta)(\theta_{(g)} - \bar\theta)^T, \qquad
              \theta_{(g)} - \theta = -(X^TX - X_g^TX_g)^{-1} X_g^T e_g

    What is left of the equations is less than their error where few of them decide, as those at reversals do: they are
    fitted. A block that is left out is not.

    Without a block that alone determines a direction nothing is known of it, and the estimate goes anywhere. At least
    one block's share of what all know is taken to be left.

    Source: A. C. Cameron, D. L. Miller, "A practitioner's guide to cluster-robust inference", J. Human Resources 50
    (2015), CR3.

    Args:
        jacobian, residual, inverse, independent: see :func:`covariance`.
        blocks: how many blocks of equally many equations there are; as many as are independent if not given.
    """
    from scipy.special import stdtrit

    size = np.sqrt(np.einsum("ij,ij->j", jacobian, jacobian))
    size = np.where(size > 0.0, size, 1.0)
    jacobian, inverse = jacobian / size, inverse * np.outer(size, size)
    blocks = blocks or int(np.clip(independent / _IN_BLOCK, _FEWEST, _MOST))
    edges = np.linspace(0, len(residual), blocks + 1).astype(int)
    value, vector = np.linalg.eigh(inverse)
    root = vector * np.sqrt(np.clip(value, 0.0, None))
    moved = []
    for first, last in pairwise(edges):
        own = jacobian[first:last] @ root
        # (A − A_g)⁻¹ s = R (1 − RᵀA_gR)⁻¹ Rᵀs with A⁻¹ = RRᵀ: by the share of what is known that the block holds.
        share, direction = np.linalg.eigh(own.T @ own)
        left = np.maximum(1.0 - share, 1.0 / blocks)
        moved.append(root @ direction @ (direction.T @ (own.T @ residual[first:last]) / left))
    apart = (np.array(moved) - np.mean(moved, axis=0)) / size
    widen = float(stdtrit(blocks - 1, 0.975)) / 1.959963984540054
    return np.asarray(widen**2 * (blocks - 1) / blocks * apart.T @ apart)
