"""Checks by fitting a model again whether an effect is what is missing that is too small in the weak form.

The weak form says whether an effect is there; how much it matters is what the error of the model with it says. Rows
allow a shift by 0.6 samples, so that a longer delay is nearly nothing in them, and all of the error of single samples.
So where nothing is large enough in the rows, what is significant there is fitted, and counts if the error falls far.

The weak form also leaves out where a drive may have stuck, or turned twice, between two samples. An effect may do
nearly all that it does there: a contact bends, a gap is crossed and friction falls within a few samples of standstill.
So where the weak form names nothing, or an effect with memory with which the error hardly falls, effects are tested on
all motion. There sampling alone may look like one of them. One counts only if most of it lies outside of the rows, or
they say so, too, but for how certain it is that the error falls, which few events do not tell. And the model that is
fitted with it must leave far less of the whole recording.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace

import numpy as np

from fricmodels.diagnosis.by_fit import most_of_the_error
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.floor import beyond_sampling_percent, is_above_noise
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.refits import Refits
from fricmodels.diagnosis.supported import Judgement, judge
from fricmodels.diagnosis.verdict import (
    LookAlikes,
    contains,
    passing_all_gates,
    significant,
    torque_share,
)
from fricmodels.weakform.problem import WeakFormProblem


def refit_check(
    refits: Refits,
    result: CandidateTests,
    leave_out: Iterable[str],
    named: LookAlikes | None,
    imitating: Collection[str] = (),
) -> LookAlikes | None:
    """Return what the weak form names, or the effect with which the error falls far, or ``None``.

    An effect with memory that explains only a small part of the error in the weak form is named only if the error of
    the fitted model falls with it, the test error too.

    Args:
        refits: fits of the model with one effect more.
        result: the tests on its residual.
        leave_out: effects that are not considered.
        named: what the weak form names; ``None`` if nothing.
        imitating: effects that, by the rows, only imitate another cause.
    """
    comparison, policy, out = refits.comparison, result.policy, set(leave_out)
    before = _error(comparison)
    if named is None:
        small = [] if passing_all_gates(result) else significant(result)
        return _best(refits, result, small, out, before) or _on_all_motion(refits, result, out, before, imitating)
    named = _with_a_simpler_one(refits, result, _led_by_fit(refits, named, policy))
    in_rows = 100 * torque_share(result, named.first.evidence)
    if not named.first.effect.states or in_rows > policy.residual_shows_error * before:
        return named
    helps, after = _helps(refits, named.first, policy), min(before, _error(refits.with_effect(named.first)))
    if helps and after < policy.replacement * before:
        return named
    again = _on_all_motion(refits, result, out, policy.replacement * after, imitating)
    return again or (named if helps else None)


def _led_by_fit(refits: Refits, named: LookAlikes, policy: Policy) -> LookAlikes:
    """Return a class of look-alikes with that first which, fitted, leaves the least test error.

    What explains the rows as well need not fit the record as well. The first in the rows gives way to one with no more
    parameters whose error is lower by the margin of an exchange, and to one with more whose error is far lower. What
    happened once gives way to what repeats with no more parameters and as low an error: that can be tested again. One
    that comes out as nothing, or as a friction that drives, is no look-alike; nor is one that explains less than half
    of the squared test error that the first does, or leaves far more of it. One that does not show with what repeats
    counted once stays in the class, behind the others; what is at its search bound does not come before what is not.
    """
    tried = named.members[: policy.step_trials]
    if len(tried) == 1:
        return named
    doubtful = [t for t in tried if t is not named.first and t.once >= policy.significance_once]
    possible = [t for t in tried if t.name not in {d.name for d in doubtful} and refits.with_effect(t) is not None]
    if not possible:
        return named
    first, *others = possible
    least = refits.test_error(first)
    for other in others:
        if other.found.at_search_bound and not first.found.at_search_bound:
            continue
        error, simple = refits.test_error(other), other.size <= first.size
        repeats = simple and first.effect.depends_on_time and not other.effect.depends_on_time
        margin = 1 + policy.exchange_margin if repeats else 1 - policy.exchange_margin if simple else policy.refit_share
        if error <= margin * least:
            first, least = other, error
    before = refits.comparison.sliding.held_out_percent
    enough = before**2 - policy.own_share * max(before**2 - least**2, 0.0)
    near = [t for t in possible if refits.test_error(t) ** 2 <= enough and refits.leaves_as_much(t, least)]
    alike = possible if least >= before else [t for t in possible if t is first or t in near]
    members = (*alike, *doubtful, *named.members[len(tried) :])
    return LookAlikes(first, (first, *(t for t in members if t is not first)))


def _with_a_simpler_one(refits: Refits, result: CandidateTests, named: LookAlikes) -> LookAlikes:
    """Return the class led by an effect that passes by itself and lies within its first, if that adds no more to it.

    Beside others of a set an effect with more parameters explains the rows better by a part of what these leave.
    Whether it is this one says the fit: the simpler one leads if its test error is higher by no more than the margin
    of an exchange.
    """
    policy, first = result.policy, named.first
    if not refits.lowers_test_error(first):
        return named
    most = (1 + policy.exchange_margin) * refits.test_error(first)
    simpler = [t for t in passing_all_gates(result) if t is not first and contains(result, first, t)]
    leading = next((t for t in sorted(simpler, key=refits.test_error) if refits.test_error(t) <= most), None)
    if leading is None:
        return named
    return LookAlikes(leading, (leading, *(t for t in named.members if t.name != leading.name)))


def _helps(refits: Refits, tested: CandidateTest, policy: Policy) -> bool:
    """Whether an effect lowers the test error, and is one that this recording can tell.

    Where the error is far above noise it must fall by a fair part. What does not fall far must fall in what sampling
    does not hide.
    """
    comparison, fitted = refits.comparison, refits.with_effect(tested)
    if fitted is None or refits.ends_at_bound(tested):
        return False
    part = 1 - policy.refit_gain if is_above_noise(comparison, policy) else 1.0
    on_test_data = fitted.sliding.held_out_percent < comparison.sliding.held_out_percent
    if not (on_test_data and _error(fitted) < part * _error(comparison)):
        return False
    falls_far = _falls_far(_error(comparison), _error(fitted), policy)
    return falls_far or beyond_sampling_percent(fitted) < beyond_sampling_percent(comparison)


def _on_all_motion(
    refits: Refits, in_rows: CandidateTests, leave_out: set[str], bound: float, imitating: Collection[str] = ()
) -> LookAlikes | None:
    """Return the effect that explains all motion and leaves less than a bound [% of the RMS torque].

    Of those that the rows see as well, and do not say to be there, the best counts if the certainty of its gain is
    lacking in them; not one that, by the rows, only imitates another cause.
    """
    comparison, policy = refits.comparison, in_rows.policy
    if _error(comparison) < policy.refit_fall:
        return None
    problem = replace(comparison.problem)  # a copy: what it remembers goes with it
    every, parameters = problem.including_uncertain_motion, comparison.estimate.parameters
    result = candidate_tests(every, parameters, leave_out=leave_out, policy=policy)
    # Few events hold what an effect does there, and of very different size, so that its gain is not significant. The
    # test error of the fitted model has to fall far in its place.
    seen = _that_gain(result)
    also = {t.name for t in _that_gain(in_rows)[:1]}.difference(imitating)
    passing = [t for t in seen if t.name in also or _share_in_rows(problem, t) < policy.judged_by_weak_form]
    return _best(refits, result, passing, leave_out, bound)


def _that_gain(result: CandidateTests) -> list[CandidateTest]:
    """Return the effects that are significant, and gain on held-out blocks, however certain that gain is."""
    return [t for t in result.tested if t.adjusted < result.policy.significance and t.evidence.gain > 0.0]


def _best(
    refits: Refits, result: CandidateTests, passing: Iterable[CandidateTest], leave_out: set[str], bound: float
) -> LookAlikes | None:
    """Return which of some effects, fitted, leaves least of the recording, if that is far less, and it is sufficient.

    Args:
        refits: fits of the model with each of them.
        result: the tests that they come from.
        passing: the effects, best first.
        leave_out: effects that are not considered.
        bound: the error must be at most this [% of the RMS torque].
    """
    policy = result.policy
    chosen = [t for t in passing if not t.found.at_search_bound][: policy.refit_trials]
    trials = sorted((_error(refits.with_effect(t)), i, t) for i, t in enumerate(chosen))
    far = [t for _, _, t in trials if _leaves_far_less(refits, t, bound)]
    if not far:
        return None
    judgement = judge(result, leave_out, LookAlikes(far[0], (far[0],)), look_ahead=False)
    by_error = any(found.first is far[0] for found in most_of_the_error(refits, judgement))
    first = far[0] if by_error else _that_stands(refits, judgement, far, bound)
    if first is None:
        return None
    error, after = (policy.alike_after_refit * e(refits.with_effect(first)) for e in (_error, _error_per_sample))
    near = [t for other, _, t in trials if other <= error and t.name != first.name]
    alike = [t for t in near if _error_per_sample(refits.with_effect(t)) <= max(after, error)]
    return LookAlikes(first, (first, *alike))


def _that_stands(refits: Refits, judgement: Judgement, far: list[CandidateTest], bound: float) -> CandidateTest | None:
    """Return the first of some effects that leave far less which is there by the rows, or ``None``.

    The one that leaves least of the recording may stand for another, which shows beside it and makes it superfluous.
    That one is what was found in the set.
    """
    there = {found.first.name: found.first for found, _ in judgement.members}
    found = [there[t.name] for t in far if t.name in there and judgement.stands(there[t.name], refits.policy)]
    return next((t for t in found if _leaves_far_less(refits, t, bound)), None)


def _leaves_far_less(refits: Refits, tested: CandidateTest, bound: float) -> bool:
    """Whether a model with an effect leaves far less of the recording, and at most a bound [% of the RMS torque]."""
    policy, comparison, fitted = refits.policy, refits.comparison, refits.with_effect(tested)
    (before, error), (samples, after) = ((e(comparison), e(fitted)) for e in (_error, _error_per_sample))
    # What rings faster than the window of the decisions shows in single samples, as far as these are no noise.
    heard = max(after, policy.noise_known_to * comparison.errors.bands[0].noise_floor_percent)
    rings = error <= policy.window_may_rise * before and _falls_far(samples, heard, policy)
    falls = rings or (error <= bound and _falls_far(before, error, policy))
    return falls and not refits.ends_at_bound(tested)


def _falls_far(before: float, after: float, policy: Policy) -> bool:
    """Whether an error [% of the RMS torque] falls by more than it does where nothing is hidden."""
    return after <= policy.refit_share * before and before**2 - after**2 > policy.refit_fall**2


def _share_in_rows(problem: WeakFormProblem, tested: CandidateTest) -> float:
    """Return which share (squared) of what an effect does on all motion lies within the rows of the weak form."""
    found = tested.found
    columns, _ = problem.columns(problem.alone(tested.effect), found.nonlinear, found.delay)
    within = tested.evidence.coefficients @ columns[found.kept]
    everywhere = tested.evidence.coefficients @ found.columns
    return float(within @ within) / float(everywhere @ everywhere)


def _error_per_sample(comparison: Comparison | None) -> float:
    """Return the error of a model in single samples, noise included [% of the RMS torque]."""
    if comparison is None:
        return float("inf")
    band = comparison.errors.bands[0]
    return float(np.sqrt(0.5 * (band.percent**2 + band.held_out_percent**2)))


def _error(comparison: Comparison | None) -> float:
    """Return the error of a model on the whole recording [% of the RMS torque]; infinite where there is no model."""
    if comparison is None:
        return float("inf")
    errors = comparison.sliding
    return float(np.sqrt(0.5 * (errors.percent**2 + errors.held_out_percent**2)))
