"""The torque equation over windows that end at each sample, compiled: of a whole run, or of the newest window alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def weak_rows(
    time: Any, velocity: Any, values: Any, window: int, resting: float, inertia: float, size: Any, torque: float
) -> Any:
    r"""Return a row ``[a…, z, use]`` for each window, shape (N − window + 1, n + 2).

    .. math::
        a_i = \frac{\int \varphi\, x_i\,dt}{\int \varphi\,dt}, \qquad
        a_J = -\frac{\int \dot\varphi\,\omega\,dt}{\int \varphi\,dt}, \qquad \varphi = (1 - s^2)^3, \quad -1 \le s \le 1

    ``use`` is 0 where two samples in a row are slower than ``resting``.

    Args:
        time, velocity: as measured, shape (N,).
        values: regressors x of the model, then the right-hand side, then the smoothed velocity, which says on which
            side of a reversal a sample is; shape (k + 2, N).
        window: samples of a window. resting: speed of rest.
        inertia: known inertia; not a number where it is estimated, which makes it the first of a row.
        size: SI size of one unit of each estimated parameter, shape (n,). torque: which rows are in.
    """
    count, known = values.shape[0] - 2, inertia == inertia
    right, sided = values[count], values[count + 1]
    first = 0 if known else 1
    rows = np.zeros((len(time) - window + 1, first + count + 2))
    measure = np.empty(window)
    for k in range(len(rows)):
        row = rows[k]
        duration = time[k + window - 1] - time[k]
        sided_measure(time[k : k + window], sided[k : k + window], measure)
        total, inertial, use = 0.0, 0.0, 1.0
        for j in range(window):
            here = k + j
            before = time[here] - time[here - 1] if j else 0.0
            after = time[here + 1] - time[here] if j < window - 1 else 0.0
            s = 2 * (time[here] - time[k]) / duration - 1
            c = 1 - s * s
            own = 0.5 * (before + after)
            phi = c * c * c
            total += phi * own
            inertial += 12 * s * c * c / duration * own * velocity[here]
            row[first + count] += phi * own * right[here]
            for i in range(count):
                row[first + i] += phi * measure[j] * values[i, here]
            if j < window - 1 and abs(sided[here]) < resting and abs(sided[here + 1]) < resting:
                use = 0.0
        if known:
            row[count] -= inertia * inertial
        else:
            row[0] = inertial
        for i in range(first + count):
            row[i] *= size[i] / (total * torque)
        row[first + count] /= total * torque
        row[first + count + 1] = use
    return rows


@njit(cache=True, nogil=True)
def sided_measure(time: Any, velocity: Any, measure: Any) -> None:
    """Write weights of the trapezium rule in which each sample counts for its own side of a reversal.

    Where the velocity changes its sign between two samples, the interval is divided at the crossing instead of in the
    middle, so that the Coulomb torque is integrated with the right sign.
    """
    measure[:] = 0.0
    for j in range(len(time) - 1):
        before, after = velocity[j], velocity[j + 1]
        share = 0.5
        if (before < 0) != (after < 0) and abs(before) + abs(after) > 0:
            share = abs(before) / (abs(before) + abs(after))
        step = time[j + 1] - time[j]
        measure[j] += share * step
        measure[j + 1] += (1 - share) * step
