"""What no model explains: the noise of the velocity, and what sampling and differentiation hide."""

from __future__ import annotations

from fricmodels.weakform.problem import WeakFormProblem, momentum_noise
from fricmodels.weakform.regression import Regression

LEAST_TORQUE = 0.003
"""An effect must come to this share of the RMS torque. What happens between samples is not recorded: on simulated
drives with nothing hidden, sampling and differentiation alone leave 0.03 to 0.3 % of it, and not as noise."""


def floor(problem: WeakFormProblem) -> float:
    """Return the sum of squares [(N m)² or N²] that noise and sampling may leave in the rows of a fitted model."""
    inertia, _ = problem.drive.split(problem.estimated or {})
    noise = inertia * momentum_noise(problem.bumps, problem.recording, problem.velocity_noise)
    return float(noise @ noise + LEAST_TORQUE**2 * (problem.driving @ problem.driving))


def share_explained(problem: WeakFormProblem, before: Regression, left: float) -> float:
    """Return which share of what a model should not have left is explained, where a sum of squares is left of it."""
    total = float(before.residual @ before.residual)
    beyond = total - floor(problem)
    return (total - left) / beyond if beyond > total - left else 1.0
