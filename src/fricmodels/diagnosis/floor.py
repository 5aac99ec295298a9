"""What no model explains: the noise of the velocity, and what sampling and differentiation hide."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import rms
from fricmodels.diagnosis.comparison import Comparison, noise_torques
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.recording import Recording
from fricmodels.score.bands import Band
from fricmodels.score.proportional import recorded_inertia
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.score.zeroed import zeroed
from fricmodels.weakform.acting import acting
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Evidence, Regression

_DRAWS, _CERTAIN = 12, 3.0
"""How often noise is drawn to see by how much its mean square varies, and so many standard deviations are chance."""


def floor(problem: WeakFormProblem, policy: Policy = POLICY) -> float:
    """Return the sum of squares [(N m)² or N²] that noise and sampling may leave in the rows of a fitted model."""
    inertia, _ = problem.drive.split(problem.estimated or {})
    return float(inertia**2 * problem.momentum_noise + policy.least_torque**2 * float(np.sum(acting(problem) ** 2)))


def creditable(problem: WeakFormProblem, before: float, fall: float, policy: Policy = POLICY) -> float:
    """Return how much of a fall of a sum of squares counts: what lies under the floor is noise, and a rise is nothing.

    Where an effect and a channel both leave no more than noise, neither explains more than the other; nor where there
    is nothing but noise.

    Args:
        problem: the fitted model and its rows.
        before, fall: sum of squared residuals that is to be explained, and by how much it falls [(N m)² or N²].
        policy: decides on the floor.
    """
    return max(min(fall, before - floor(problem, policy)), 0.0)


def above_noise(problem: WeakFormProblem, left: float, policy: Policy) -> float:
    """Return what a sum of squares has above the floor, and above noise of the motor torque [(N m)² or N²].

    That noise is what alternates too fast for anything else, and no floor for the search: an effect explains beside it.
    """
    return max(left - floor(problem, policy) - problem.torque_noise, 0.0)


def share_explained(problem: WeakFormProblem, before: float, left: float, policy: Policy = POLICY) -> float:
    """Return which share of a sum of squares is explained, of what lies above noise.

    Args:
        problem: the fitted model and its rows.
        before, left: sum of squared residuals that is to be explained, and what is left of it [(N m)² or N²].
        policy: decides on the floor.
    """
    above = above_noise(problem, before, policy)
    return (before - left) / above if above > max(before - left, 0.0) else 1.0 if before > left else 0.0


def leaves_nothing(problem: WeakFormProblem, before: float, left: float, policy: Policy) -> bool:
    """Whether what is left of a sum of squares is above noise by less than a gain that counts, that of the policy."""
    return share_explained(problem, before, left, policy) >= 1.0 - policy.least_gain


def gain_above_noise(problem: WeakFormProblem, regression: Regression, evidence: Evidence, policy: Policy) -> float:
    """Return by which share columns lower the RMS of a residual on held-out blocks, but for what noise leaves of it.

    Where noise is nearly all of it no effect could lower it by much, however certain it is.

    Args:
        problem: the fitted model and its rows.
        regression: without the columns.
        evidence: for them.
        policy: decides on the floor.
    """
    before = float(np.sum(regression.loss))
    share = share_explained(problem, before, (1.0 - evidence.gain) ** 2 * before, policy)
    return 1.0 - float(np.sqrt(max(1.0 - share, 0.0)))


def is_above_noise(comparison: Comparison, policy: Policy = POLICY) -> bool:
    """Whether the error is far more than the noise of the sensors leaves, where it was fitted or where it was not."""
    sliding = comparison.sliding
    return _is_far_above((sliding.percent, sliding.held_out_percent), comparison, policy)


def is_far_above_noise(comparison: Comparison, policy: Policy = POLICY) -> bool:
    """Whether the error is far more than noise and sampling leave, even where no channel predicts it."""
    seen = is_seen_above_noise(comparison, policy) and _is_far_above(_beyond_sampling(comparison), comparison, policy)
    return seen or is_large(comparison, policy)


def is_large(comparison: Comparison, policy: Policy) -> bool:
    """Whether what neither noise nor sampling leaves is a large part of the torque in the window that users are shown.

    What lasts for a few samples only is averaged away in the window of the decisions: a motion that begins with a jump,
    since an encoder has play, needs a force that nobody gave.
    """
    line, interval = comparison.errors.headline, comparison.train.interval
    least = max(policy.large_error, policy.large_of_noise * line.noise_floor_percent)
    if min(line.percent, line.held_out_percent) < least:
        return False
    return min(_beyond_sampling(comparison, max(1, round(0.5e-3 * line.window_ms / interval)))) >= least


def is_seen_above_noise(comparison: Comparison, policy: Policy) -> bool:
    """Whether the error is far more than noise, and that which users are shown is more than noise as well.

    With much noise the window of the decisions is longer than any that is shown, and as long as a stroke it leaves an
    error of its own: where counts of an encoder made the velocity it left 8 %, and the model 0.7 over a tenth of a
    second.
    """
    line = comparison.errors.headline
    return is_above_noise(comparison, policy) and line.above_noise() > 0.0


def is_noticed(comparison: Comparison, percent: float, policy: Policy = POLICY) -> bool:
    """Whether what could be predicted makes up a noticeable part of the error that users are shown, or of the torque.

    A part of the torque is noticed beside any error: that of single samples has what sampling makes, ten times as much
    where a drive turns often, and the motion between the turns is wrong all the same.

    The error must be more than the noise was estimated to leave, where it was fitted and where it was not, and in some
    window by as large a part of it: else what a channel predicts is the noise itself, as that of the counts from which
    a drive derives its velocity.

    Args:
        comparison: the fitted model.
        percent: RMS torque that a channel predicts, in % of the RMS torque.
        policy: decides how much is noticed.
    """
    line, bands = comparison.errors.headline, comparison.errors.bands
    whole = 0.5 * (line.percent**2 + line.held_out_percent**2)
    least = min((policy.noticed * whole) ** 0.5, policy.noticed_torque)
    is_clear = any(band.above_noise() > policy.noticed * _least_square(band) for band in bands)
    return line.above_noise() > 0.0 and is_clear and percent >= least


def _least_square(band: Band) -> float:
    """Return the mean square of an error where it was fitted and where it was not, or on test data if less [%²]."""
    return min(0.5 * (band.percent**2 + band.held_out_percent**2), band.held_out_percent**2)


def _is_far_above(percents: tuple[float, float], comparison: Comparison, policy: Policy) -> bool:
    """Whether an error is far above noise on either part: what was fitted, and what was kept back.

    Few windows of noise may by chance be far larger than it is on average.
    """
    sliding = comparison.sliding
    parts = (comparison.train, sliding.noise_percent), (comparison.test, sliding.held_out_noise_percent)
    for percent, (part, noise) in zip(percents, parts, strict=True):
        least = policy.far_above_noise**2 + (policy.noise_known_to * noise) ** 2
        if percent**2 > least and percent**2 > least + _chance(comparison, part) * (policy.noise_known_to * noise) ** 2:
            return True
    return False


def _chance(comparison: Comparison, part: Recording) -> float:
    """Return by which share the mean square of noise may exceed its expectation by chance: three standard deviations.

    That noise is drawn a few times.
    """
    inertia = recorded_inertia(comparison.drive, comparison.estimate.parameters)
    half_width = sliding_half_width(comparison.train)
    drawn = [np.hypot(*noise_torques(part, inertia, half_width, draw)) ** 2 for draw in range(_DRAWS)]
    mean, first = float(np.mean(drawn)), float(drawn[0])
    return (mean - first + _CERTAIN * float(np.std(drawn, ddof=1))) / first if first > 0.0 else 0.0


def beyond_sampling_percent(comparison: Comparison) -> float:
    """Return the error that is left without what sampling hides, in % of the RMS torque; see `score.sampling`.

    Of what was fitted and what was kept back, the larger.
    """
    return max(_beyond_sampling(comparison))


def _beyond_sampling(comparison: Comparison, half_width: int | None = None) -> tuple[float, float]:
    drive, values = comparison.drive, comparison.estimate.parameters
    half_width = half_width or sliding_half_width(comparison.train)

    def percent(part: Recording) -> float:
        error = filtered_torque_error(drive, values, part, half_width, beyond_sampling=True)
        return 100 * rms(error) / part.rms_torque

    return percent(comparison.train), percent(zeroed(drive, values, comparison.test))
