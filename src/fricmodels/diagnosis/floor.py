"""What no model explains: the noise of the velocity, and what sampling and differentiation hide."""

from __future__ import annotations

import numpy as np

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.score.zeroed import zeroed
from fricmodels.weakform.problem import WeakFormProblem


def floor(problem: WeakFormProblem, policy: Policy = POLICY) -> float:
    """Return the sum of squares [(N m)² or N²] that noise and sampling may leave in the rows of a fitted model."""
    inertia, _ = problem.drive.split(problem.estimated or {})
    return float(inertia**2 * problem.momentum_noise + policy.least_torque**2 * (problem.driving @ problem.driving))


def share_explained(problem: WeakFormProblem, before: float, left: float, policy: Policy = POLICY) -> float:
    """Return which share of a sum of squares above the floor, and above noise of the motor torque, is explained.

    That noise is what alternates too fast for anything else, and no floor for the search: an effect explains beside it.

    Args:
        problem: the fitted model and its rows.
        before, left: sum of squared residuals that is to be explained, and what is left of it [(N m)² or N²].
        policy: decides on the floor.
    """
    above = before - floor(problem, policy) - problem.torque_noise
    return (before - left) / above if above > before - left else 1.0


def is_above_noise(comparison: Comparison, policy: Policy = POLICY) -> bool:
    """Whether the error is far more than the noise of the sensors leaves."""
    sliding = comparison.sliding
    return _is_far_above(max(sliding.percent, sliding.held_out_percent), comparison, policy)


def is_far_above_noise(comparison: Comparison, policy: Policy = POLICY) -> bool:
    """Whether the error is far more than noise and sampling leave, even where no channel predicts it."""
    return is_above_noise(comparison, policy) and _is_far_above(beyond_sampling_percent(comparison), comparison, policy)


def _is_far_above(percent: float, comparison: Comparison, policy: Policy) -> bool:
    noise = policy.noise_known_to * comparison.sliding.noise_percent
    return percent**2 - noise**2 > policy.far_above_noise**2


def beyond_sampling_percent(comparison: Comparison) -> float:
    """Return the error that is left without what sampling hides, in % of the RMS torque; see `score.sampling`.

    Of what was fitted and what was kept back, the larger.
    """
    drive, values, half_width = comparison.drive, comparison.estimate.parameters, sliding_half_width(comparison.train)
    found = []
    for part in (comparison.train, zeroed(drive, values, comparison.test)):
        error = filtered_torque_error(drive, values, part, half_width, beyond_sampling=True)
        found.append(100 * float(np.sqrt(np.mean(error**2) / np.mean(part.torque**2))))
    return max(found)
