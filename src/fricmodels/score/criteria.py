"""Information criteria for residuals whose neighbouring samples are alike."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index


def information_criteria(error: Array, run: Index, parameters: int) -> tuple[float, float, float]:
    r"""Return AIC, BIC and the effective number of samples of a torque error.

    Neighbouring samples of a torque error are alike, and do not count as one piece of evidence each. With the
    integrated autocorrelation time of the residual (Sokal's window: the least m with m ≥ 5 τ)

    .. math:: \tau = 1 + 2\sum_{k=1}^{m} \rho_k, \qquad N_e = N/\max(\tau, 1)

    .. math:: \mathrm{AIC} = N_e\ln\overline{T_e^2} + 2p, \qquad \mathrm{BIC} = N_e\ln\overline{T_e^2} + p\ln N_e

    Args:
        error: torque error, shape (N,).
        run: run number of each sample; no correlation is counted from one run to the next.
        parameters: number p of estimated parameters.

    Source: A. Sokal, "Monte Carlo methods in statistical mechanics", 1989; H. Akaike, 1974; G. Schwarz, 1978.
    """
    count = len(error)
    mean_square = float(np.mean(error**2))
    if not mean_square > 0 or not np.isfinite(mean_square):
        return float("nan"), float("nan"), float(count)
    covariance = np.zeros(count)
    for number in np.unique(run):
        part = error[run == number]
        spectrum = np.fft.rfft(part, 2 * len(part))
        covariance[: len(part)] += np.fft.irfft(np.abs(spectrum) ** 2)[: len(part)]
    times = 2 * np.cumsum(covariance / covariance[0]) - 1
    wide_enough = np.flatnonzero(np.arange(count) >= 5 * times)
    time = times[wide_enough[0]] if len(wide_enough) else times[-1]
    effective = count / max(float(time), 1.0)
    evidence = effective * np.log(mean_square)
    return float(evidence + 2 * parameters), float(evidence + parameters * np.log(effective)), effective
