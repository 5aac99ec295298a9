"""The fit at a velocity that has back what smoothing took away.

Friction is evaluated at a smoothed velocity. The filter is as wide as the error of a single sample asks for; what it
takes away of the motion is the same in every sample of its kind and does not average out, while the noise does. So a
fit that needs no single sample is better off with more noise and less bias: the same filter, of what it left over,
gives back all but the square of what it takes away. Candidates are tested at the plain smoothed velocity, whose noise
is less and of which more is known.

Source: J. W. Tukey, "Exploratory data analysis", 1977 (twicing).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording
from fricmodels.signals import lanczos_derivative
from fricmodels.signals.integrated import way
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.solve import Solved, solve


def at_sharpened_velocity(found: Solved) -> Solved:
    """Return the fit to the same rows with friction evaluated at the sharpened velocity.

    Args:
        found: the fit at the smoothed velocity.
    """
    problem = found.problem
    taken = smoothed_away(problem.recording, problem.smooth, problem.half_width)
    velocity = np.where(problem.smooth != 0.0, problem.smooth + taken, 0.0)
    quadrature = Quadrature.of(problem.recording, velocity, problem.test_functions.left_out)
    return solve(replace(problem, smooth=velocity, quadrature=quadrature), found.again, timing=found.timing)


def smoothed_away(recording: Recording, smooth: Array, half_width: int) -> Array:
    """Return what smoothing took away from the velocity, as the measurement shows it, shape (N,).

    Where the velocity was derived, it is what the positions differ by from the path that goes with the smoothed one.

    Args:
        recording: with the velocity as it was before it was smoothed.
        smooth: the smoothed velocity, shape (N,).
        half_width: of the filter that smoothed it.
    """
    time, run = recording.time, recording.run
    left = recording.velocity - smooth
    if recording.derived_over:
        left = lanczos_derivative(time, recording["position"] - way(time, smooth), recording.derived_over, run)[1]
    return lanczos_derivative(time, left, half_width, run)[0]
