"""Standard errors that hold for autocorrelated residuals, and which parameters a recording does not determine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
    return np.asarray(widen**2 * inverse @ meat @ inverse)
