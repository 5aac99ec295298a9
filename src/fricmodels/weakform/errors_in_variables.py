r"""Noise in a regressor, which makes its coefficient too small.

Where the noise is known, :math:`X^T X - N` is what X without it would give.

Source: W. A. Fuller, "Measurement error models", 1987, ch. 2.
"""

from __future__ import annotations

import math

from fricmodels.arrays import Array
from fricmodels.weakform.least_squares import first_alone


def noise_of_first(known: float, theta: Array, left: float) -> float:
    r"""Return what noise adds to the square of the first column, of dω/dt: no more than what is left says.

    Noise e of it leaves :math:`J^2 e^T e` by itself; plain least squares, whose inertia is too small by the share λ of
    noise, leaves :math:`J^2 e^T e (1 - \lambda)` or more, which is more than :math:`J_0^2 e^T e`. So a noise that is
    known is never cut, and one that was taken too large, as where a fast ripple of the speed looks like it, mostly is.

    Args:
        known: what noise is known to add.
        theta: plain least squares, the inertia J₀ first.
        left: squared error of plain least squares.
    """
    square = float(theta[0]) ** 2
    return min(known, max(left, 0.0) / square if square > 0.0 else math.inf)


def without_noise(gram: Array, noise: float) -> Array:
    """Return products of columns without what noise adds to the first with itself.

    At most half of what the other columns leave of it is taken away.
    """
    if not noise:
        return gram
    less, alone = gram.copy(), first_alone(gram)
    less[0, 0] -= min(noise, 0.5 * alone) if alone < math.inf else 0.0
    return less
