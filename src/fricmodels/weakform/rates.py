r"""Runs that were sampled at different rates, or are more or less noisy: how much a row of each counts.

A test function spans as many samples in every run. Noise of the velocity is then as large in each row, but noise of
the torque, and what no model explains, grow with the interval. A row counts by the inverse of what it is expected to
leave: without that, of a run at 1 kHz and one at 50 Hz rows of the second, twenty times as large, decided everything;
and so did those of a noisy run beside a quiet one.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.weakform.stretches import cells_of

UNEXPLAINED = 0.01
"""Share of the RMS torque that is taken to be unexplained by any model: where nothing has noise, too, rows of all rates
count."""
_SAME = 1.4
"""Ratio ρ of intervals up to which they are one rate. Rows of both then count as the squares of these, and a fit to as
much of both is less certain for it: its errors grow by √(2 (1 + ρ⁴)) / (1 + ρ²), 5 % at the most."""


_FEW = 20
"""Intervals of a run below which it has the rate of all: a few that vary are no rate of their own."""


@once
def relative_intervals(recording: Recording) -> Array:
    """Return the mean interval of each sample's run over the recording's interval, (N,); 1 where all have one rate.

    Gaps aside. A logger that writes in two intervals by turns has one rate.
    """
    if len(recording.run_numbers) > 1:
        length, joined = cells_of(recording)
        run = np.unique(recording.run, return_inverse=True)[1]
        count = np.bincount(run[:-1][joined], minlength=run.max() + 1)
        mean = np.bincount(run[:-1][joined], length[joined], run.max() + 1) / np.maximum(count, 1)
        known = count > _FEW
        if known.any() and mean[known].max() > _SAME * mean[known].min():
            return np.asarray(np.where(known, mean / recording.interval, 1.0)[run])
    return np.ones(len(recording))


def weights_of_rows(relative: Array, of_momentum: Array, of_torque: Array, unexplained: float) -> Array:
    r"""Return by how much a row counts that begins at each sample, shape (N,); half of them by more than 1.

    .. math:: w \propto \left(v^2 + (t^2 + u^2)\,r^2\right)^{-1/2}

    Args:
        relative: r, see :func:`relative_intervals`.
        of_momentum: v, RMS of what noise of the velocity leaves in a row of its run, shape (N,).
        of_torque: t, RMS of what noise of the torque leaves in it, at the recording's own interval, shape (N,).
        unexplained: u, RMS of what no model explains, at that interval.
    """
    squares = of_momentum**2 + (of_torque**2 + unexplained**2) * relative**2
    weights = 1.0 / np.sqrt(squares) if np.all(squares > 0.0) else 1.0 / relative
    return np.asarray(weights / np.median(weights))
