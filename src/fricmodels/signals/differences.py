"""Velocities that are differences of the positions beside them."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.recording import Recording

_EQUAL, _EXCEPTIONS = 1e-3, 0.01
"""Share of the RMS velocity to which a computed velocity equals the difference, and share of samples that may not."""
_AS_ROUGH = 0.5
"""Share of the roughness of a difference that a velocity has which is one."""
_LEAST, _MOST = 50, 100_000
"""Samples from which that is told; of a longer record so many in its middle."""


def is_difference(recording: Recording) -> bool:
    """Whether the velocity is a difference of the recorded positions: backward, forward, central or a parabola's slope.

    The last is what `numpy.gradient` gives for unequal steps; for equal ones it is the central difference. All but a
    hundredth of the samples, beginnings and lost ones among them, must be equal to a thousandth of the RMS. A measured
    velocity may be, too, where samples come fast; but it has not the noise of such a difference, so that its fourth
    differences are far less.
    """
    some = slice(max(0, (len(recording) - _MOST) // 2), (len(recording) + _MOST) // 2)
    time, position, velocity = recording.time[some], recording["position"][some], recording.velocity[some]
    inside = np.diff(recording.run[some]) == 0
    if np.count_nonzero(inside) < _LEAST:
        return False
    allowed = _EQUAL * rms(velocity)
    steps, changes = np.where(inside, np.diff(time), np.inf), np.diff(position)
    between = inside[1:] & inside[:-1]
    wide = np.where(between, time[2:] - time[:-2], np.inf)
    slope = changes / steps
    later = np.where(between, np.diff(time)[:-1] / wide, 0.0)
    forms = (
        (slope, velocity[1:], inside),
        (slope, velocity[:-1], inside),
        ((position[2:] - position[:-2]) / wide, velocity[1:-1], between),
        (slope[:-1] + later * (slope[1:] - slope[:-1]), velocity[1:-1], between),
    )
    return any(
        float(np.mean(np.abs(form - own)[counts] <= allowed)) > 1.0 - _EXCEPTIONS
        and _roughness(own[counts]) >= _AS_ROUGH * _roughness(form[counts])
        for form, own, counts in forms
    )


def _roughness(values: Array) -> float:
    """Return the RMS of fourth differences, but for the largest: of exceptions each is in five of them."""
    squares = np.sort(np.diff(values, 4) ** 2)
    return float(np.sqrt(np.mean(squares[: int((1.0 - 5.0 * _EXCEPTIONS) * len(squares))])))
