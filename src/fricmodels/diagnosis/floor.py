"""What no model explains: the noise of the velocity, and what sampling and differentiation hide."""

from __future__ import annotations

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.weakform.problem import WeakFormProblem


def floor(problem: WeakFormProblem, policy: Policy = POLICY) -> float:
    """Return the sum of squares [(N m)² or N²] that noise and sampling may leave in the rows of a fitted model."""
    inertia, _ = problem.drive.split(problem.estimated or {})
    return float(inertia**2 * problem.momentum_noise + policy.least_torque**2 * (problem.driving @ problem.driving))


def share_explained(problem: WeakFormProblem, before: float, left: float, policy: Policy = POLICY) -> float:
    """Return which share of a sum of squares above the floor is explained.

    Args:
        problem: the fitted model and its rows.
        before, left: sum of squared residuals that is to be explained, and what is left of it [(N m)² or N²].
        policy: decides on the floor.
    """
    above = before - floor(problem, policy)
    return (before - left) / above if above > before - left else 1.0


def is_far_above_noise(comparison: Comparison, policy: Policy = POLICY) -> bool:
    """Whether the error is more than noise and sampling leave, even where no channel predicts it."""
    worst = max(comparison.sliding.percent, comparison.sliding.held_out_percent)
    noise = policy.noise_known_to * comparison.sliding.noise_percent
    return worst**2 - noise**2 > policy.far_above_noise**2
