"""From evidence to an answer: an effect with its look-alikes, or none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.floor import gain_above_noise
from fricmodels.weakform.acting import acting
from fricmodels.weakform.all_motion import residual_rms
from fricmodels.weakform.regression import Evidence, Regression, compare


@dataclass(frozen=True)
class LookAlikes:
    """The effect that explains a residual best, and those that explain it as well."""

    first: CandidateTest
    members: tuple[CandidateTest, ...]

    @property
    def names(self) -> list[str]:
        """Names of the class, best first."""
        return [t.name for t in self.members]


def passing_all_gates(result: CandidateTests) -> list[CandidateTest]:
    """Return the candidates that are significant, gain, and are large enough in the weak form or over all motion.

    Size over all motion counts only for an effect whose residual comes near the best one in the weak form.
    """
    passing = passing_significance(result)
    nearest = result.policy.far_worse * min(
        (_rms(result, t) for t in passing if not t.found.at_search_bound), default=np.inf
    )
    return [
        t
        for t in passing
        if torque_share(result, t.evidence) > result.policy.least_torque
        or (_rms(result, t) < nearest and is_large_over_all_motion(result, t))
    ]


def passing_significance(result: CandidateTests) -> list[CandidateTest]:
    """Return the candidates that are significant and gain on held-out blocks, however small they are."""
    level = result.policy.effect_gain_significance
    return [t for t in result.tested if _is_sure(result, t.evidence, t.adjusted, level)]


def significant(result: CandidateTests) -> list[CandidateTest]:
    """Return the candidates that are significant, and gain on held-out blocks by whatever share of the residual."""
    policy = result.policy
    return [
        t
        for t in result.tested
        if t.adjusted < policy.significance
        and t.evidence.gain > 0.0
        and t.evidence.gain_p_value < policy.effect_gain_significance
    ]


def predicts(result: CandidateTests, evidence: Evidence, p_value: float, *, as_rival: bool = False) -> bool:
    """Whether a channel predicts a residual: it is significant, gains on held-out blocks, and is large enough.

    Args:
        result: the residual.
        evidence: of the channel's basis functions.
        p_value: corrected for the number of channels.
        as_rival: whether it stands against an effect. Then its gain counts at the level at which the effect's does:
            where few events hold the gain of both, neither may win by a stricter test of the other.
    """
    policy = result.policy
    level = policy.effect_gain_significance if as_rival else policy.predictor_gain_significance
    sure = _is_sure(result, evidence, p_value, level) and (as_rival or evidence.gain > policy.least_gain)
    return sure and torque_share(result, evidence) > policy.least_torque


def _is_sure(result: CandidateTests, evidence: Evidence, p_value: float, gain_level: float) -> bool:
    policy = result.policy
    if p_value >= policy.significance or evidence.gain_p_value >= gain_level or evidence.gain <= 0.0:
        return False
    return gain_above_noise(result.problem, result.regression, evidence, policy) > policy.least_gain


def is_large_over_all_motion(result: CandidateTests, tested: CandidateTest) -> bool:
    """Whether an effect that single samples can judge takes away enough of what a model leaves over all motion."""
    if not _can_be_judged_by_samples(result, tested):
        return False
    problem = result.problem
    power = float(np.mean(problem.recording.torque[~problem.resting] ** 2)) or problem.recording.rms_torque**2
    fall = residual_rms(problem) ** 2 - _left_over_all_motion(result, tested) ** 2
    return fall > result.policy.least_torque_all_motion**2 * power


def torque_share(result: CandidateTests, evidence: Evidence) -> float:
    """Return the RMS torque that columns explain beyond the base model, over the RMS torque."""
    explained = evidence.explained * float(np.mean(result.regression.residual**2))
    return float(np.sqrt(max(explained, 0.0) / np.mean(acting(result.problem) ** 2)))


def select_effect(result: CandidateTests) -> LookAlikes | None:
    """Return the best effect with its look-alikes, or ``None`` where no candidate passes."""
    policy = result.policy
    # An effect at its search bound only resembles what is missing; any other that passes is more likely.
    passing = sorted(passing_all_gates(result), key=lambda t: (t.found.at_search_bound, _cost(result, t)))
    before = residual_rms(result.problem) if passing else 0.0
    first = next((t for t in passing if not _spoils(result, t, before)), None)
    if first is None:
        return None
    members = [first]
    best = _rms(result, first)
    near = policy.alike_of_model * float(np.sqrt(np.mean(result.regression.loss)))
    for other in (*passing[passing.index(first) + 1 :], *_better_but_for_their_number(result, first)):
        _, p_worse = compare(other.evidence.loss, first.evidence.loss, result.regression.terms)
        not_worse = p_worse > policy.alike_significance and _rms(result, other) < policy.far_worse * best
        if not (_rms(result, other) - best < near or not_worse):
            continue
        if contains(result, other, first) and first.name not in other.effect.distinct_from:
            continue
        if not _spoils(result, other, before):
            members.append(other)
    return LookAlikes(first, tuple(members))


def _better_but_for_their_number(result: CandidateTests, first: CandidateTest) -> list[CandidateTest]:
    """Return candidates that would come before the first effect, and fail only as so many effects were tried.

    That any effect is there is one question of many, and the first one has answered it. Whether it is this one or the
    other is a question of its own.
    """
    policy, least = result.policy, _cost(result, first)
    return [
        t
        for t in result.tested
        if t.p_value < policy.significance <= t.adjusted
        and not t.found.at_search_bound
        and _cost(result, t) < least
        and _is_sure(result, t.evidence, t.p_value, policy.effect_gain_significance)
        and torque_share(result, t.evidence) > policy.least_torque
    ]


def _spoils(result: CandidateTests, tested: CandidateTest, before: float) -> bool:
    """Whether an effect makes far worse what a model leaves over all motion [N m or N]."""
    if not _can_be_judged_by_samples(result, tested):
        return False
    return _left_over_all_motion(result, tested) > result.policy.worse_over_all_motion * before


def _can_be_judged_by_samples(result: CandidateTests, tested: CandidateTest) -> bool:
    """Whether the residual of single samples says anything of an effect; of a rate of the torque it does not."""
    return "motor_torque_rate" not in result.problem.alone(tested.effect).model.needs


def _left_over_all_motion(result: CandidateTests, tested: CandidateTest) -> float:
    """Return the RMS torque that an effect leaves over all motion [N m or N]."""
    alone = result.problem.alone(tested.effect)
    return residual_rms(result.problem, alone, tested.found.nonlinear, tested.found.kept)


def _rms(result: CandidateTests, tested: CandidateTest) -> float:
    """Return the RMS residual with an effect; what sampling leaves at the least counts as left by each."""
    loss, torque = tested.evidence.loss, acting(result.problem)
    least = result.policy.sampling_leaves**2 * float(torque @ torque)
    return float(np.sqrt((np.sum(loss) + least) / len(loss)))


def _cost(result: CandidateTests, tested: CandidateTest) -> float:
    return round(float(np.log(_rms(result, tested))), 8) + result.policy.parameter_price * len(tested.effect.parameters)


def contains(result: CandidateTests, larger: CandidateTest, smaller: CandidateTest) -> bool:
    """Whether everything that the smaller effect adds lies within what the larger one can add."""
    if len(larger.effect.parameters) <= len(smaller.effect.parameters):
        return False
    return outside(result.regression, smaller.found.columns, larger.found.columns) < result.policy.contained


def outside(regression: Regression, columns: Array, others: Array) -> float:
    """Return which share (squared) of columns lies outside of others, beyond what the base model can do itself."""
    own = regression.project_out(columns)
    basis = np.linalg.svd(regression.project_out(others), full_matrices=False)[2]
    left = own - (own @ basis.T) @ basis
    return float(np.sum(left**2) / np.sum(own**2))
