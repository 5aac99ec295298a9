"""Whether the effect that explains a residual best is what is missing, or only resembles it.

Where the true effect is not among the candidates, some other one still explains a part of the residual, significantly.
Channel predictors, which assume no physics, show that: one of them predicts more than the effect does. The effect is
then named only if several effects together explain more than any channel and leave nothing that could be predicted.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.basis_functions import FINELY, FINELY_ALONG, FINELY_TORQUE
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests
from fricmodels.diagnosis.floor import floor, share_explained
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor, channel_predictors, each_predictor
from fricmodels.diagnosis.verdict import outside, passing_all_gates, predicts, select_effect
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of

Array = NDArray[np.float64]


def passing_predictors(result: CandidateTests) -> list[ChannelPredictor]:
    """Return the channel predictors of the residual that pass all gates, best first."""
    return [p for p in channel_predictors(result) if predicts(result, p.evidence, p.p_value)]


def is_sufficient(
    result: CandidateTests, leave_out: Iterable[str], first: CandidateTest, predictors: Sequence[ChannelPredictor]
) -> bool:
    """Whether an effect is what is missing, alone or together with further ones, and not only resembles it.

    Args:
        result: the tests that it comes from.
        leave_out: effects that are not considered.
        first: the effect.
        predictors: the channel predictors that pass, best first.
    """
    if first.found.at_search_bound:
        return False
    at_bound = [t for t in passing_all_gates(result) if t.found.at_search_bound]
    rivals = [*predictors, *(as_predictor(result, tested) for tested in at_bound)]
    rivals.sort(key=lambda rival: float(np.sum(rival.evidence.loss)))
    in_doubt = outpredicted_by_channel(result, first, rivals) or explains_too_little(result, first, predictors)
    return not in_doubt or combination_suffices(result, leave_out, rivals)


def as_predictor(result: CandidateTests, tested: CandidateTest) -> ChannelPredictor:
    """Return an effect that is not what is missing as a predictor from the channels on which it depends."""
    needs = " and ".join(sorted(result.problem.alone(tested.effect).model.needs)).replace("_", " ")
    channels = "the course of the motion before" if tested.effect.states else needs or "a constant torque"
    columns = columns_and_tangents(result, tested)
    return ChannelPredictor(f"{channels}, as in '{tested.name}'", tested.evidence, tested.adjusted, columns)


def outpredicted_by_channel(
    result: CandidateTests, first: CandidateTest, predictors: Sequence[ChannelPredictor]
) -> bool:
    """Whether some channel predicts significantly and much more than an effect.

    Two predictors are excepted. The past of the residual or of the torque shows all that lasts, whatever the number of
    its causes; an effect without memory need only explain half of that. A periodic effect is not refused by further
    waves over position: poles, slots and teeth have each their own.
    """
    policy = result.policy
    total, own = float(np.sum(result.regression.loss)), float(np.sum(first.evidence.loss))
    least = max(policy.least_torque**2 * float(np.sum(result.problem.driving**2)), policy.outpredicted_by * total)
    half = policy.half_of_autoregression
    for predictor in predictors:
        if _is_of_its_kind(result, first, predictor):
            continue
        left = float(np.sum(predictor.evidence.loss))
        lasting = predictor.channels in AUTOREGRESSIVE and not first.effect.states
        more = own > (1 - half) * total + half * left if lasting else own - left > least
        if more and _predicts_more(result, predictor.evidence.loss, first.evidence.loss):
            return True
    return False


def _predicts_more(result: CandidateTests, loss: Array, other: Array) -> bool:
    """Whether a squared held-out residual is significantly smaller than another one, both of shape (rows,)."""
    return compare(other, loss, result.regression.terms)[1] < result.policy.outpredicted_significance


def explains_too_little(result: CandidateTests, first: CandidateTest, predictors: Sequence[ChannelPredictor]) -> bool:
    """Whether an effect leaves too much to be what is missing by itself.

    An effect with memory can imitate most others, so that more is asked of it: it must explain most of the residual,
    and no channel may predict what it leaves.
    """
    policy = result.policy
    left = float(first.evidence.residual @ first.evidence.residual)
    share = share_explained(result.problem, result.regression, left, policy)
    if not first.effect.states:
        return share < policy.explains_alone
    if share < policy.explains_by_count[0]:
        return True
    columns = columns_and_tangents(result, first)
    with_it = regression_of(result.problem, result.parameters, columns, first.effect)
    return not _leaves_nothing_predictable(result, with_it, predictors)


def _is_of_its_kind(result: CandidateTests, tested: CandidateTest, predictor: ChannelPredictor) -> bool:
    """Whether an effect is periodic, and a predictor consists of waves of that kind within which the effect lies."""
    if not any(p.periodic for p in tested.effect.parameters):
        return False
    along = FINELY_ALONG if tested.effect.symmetry == "odd" else FINELY
    kind = FINELY_TORQUE if "motor_torque" in result.problem.alone(tested.effect).model.needs else along
    if predictor.channels != kind:
        return False
    own = tested.evidence.coefficients[None] @ tested.found.columns
    return outside(result.regression, own, predictor.columns) < result.policy.outside_own_kind


def combination_suffices(
    result: CandidateTests, leave_out: Iterable[str], predictors: Sequence[ChannelPredictor]
) -> bool:
    """Whether effects found one after the other explain more than any channel, and leave nothing to predict.

    Where one channel explains nearly as much as all of them together, one cause is the simpler explanation. The past of
    the residual or of the torque is such a channel only where one of the effects has a memory.
    """
    problem, policy, out = result.problem, result.policy, set(leave_out)
    columns, found = np.zeros((0, problem.rows)), result
    remembers = False
    for count, least in enumerate(policy.explains_by_count):
        if count:
            found = candidate_tests(problem, result.parameters, leave_out=out, also=columns, policy=policy)
        best = select_effect(found)
        if best is None or best.first.found.at_search_bound:
            return False
        columns = np.vstack([columns, columns_and_tangents(found, best.first)])
        out.add(best.first.name)
        remembers |= bool(best.first.effect.states)
        together = regression_of(problem, result.parameters, columns, best.first.effect)
        if share_explained(problem, result.regression, float(np.sum(together.loss)), policy) < least:
            continue
        if _leaves_nothing_predictable(result, together, predictors):
            single = next((p for p in predictors if remembers or p.channels not in AUTOREGRESSIVE), None)
            return single is None or _is_simpler(result, columns, together.loss, single)
    return False


def _leaves_nothing_predictable(
    result: CandidateTests, regression: Regression, predictors: Sequence[ChannelPredictor]
) -> bool:
    """Whether no channel predicts much of what is left of a residual.

    The past of the residual or of the torque does not count: on a real drive something always lasts. Nor is there
    anything to predict where hardly more is left than noise and sampling leave.

    Args:
        result: the residual.
        regression: with the effects, which leave part of it.
        predictors: channel predictors that are tried first.
    """
    least, left = result.policy.left_to_channels, float(np.sum(regression.loss))
    if share_explained(result.problem, result.regression, left, result.policy) > 1 - least:
        return True
    after = replace(result, regression=regression, tested=(), untested={})
    most = left - least * float(np.sum(result.regression.loss))
    return not any(
        predicts(after, p.evidence, p.p_value) and np.sum(p.evidence.loss) < most
        for p in each_predictor(after, [p.channels for p in predictors])
        if p.channels not in AUTOREGRESSIVE
    )


def _is_simpler(result: CandidateTests, columns: Array, together: Array, single: ChannelPredictor) -> bool:
    """Whether effects together are simpler than one channel: they leave far less, or as little with far fewer terms.

    Whatever is less than noise and sampling leave counts as little.

    Args:
        result: the residual.
        columns: of all effects together, shape (k, rows).
        together: squared held-out residual that they leave, shape (rows,).
        single: the channel that predicts best.
    """
    share, alone, left = result.policy.combination_against_channel, single.evidence.loss, float(np.sum(together))
    terms = len(single.columns) / len(columns)
    if left < share * min(1.0, terms) * np.sum(alone) and _predicts_more(result, together, alone):
        return True
    no_worse = left <= floor(result.problem, result.policy) or not _predicts_more(result, alone, together)
    return share * terms > 1 and no_worse


def columns_and_tangents(result: CandidateTests, tested: CandidateTest) -> Array:
    """Return an effect's columns and the tangents of its nonlinear parameters, shape (k, rows)."""
    problem, found = result.problem, tested.found
    alone = problem.alone(tested.effect)
    stacked = [found.columns]
    for i, value in enumerate(found.nonlinear):
        step = 1e-4 * abs(value) or 1e-6
        ends = []
        for moved in (value - step, value + step):
            columns, _ = problem.columns(alone, (*found.nonlinear[:i], moved, *found.nonlinear[i + 1 :]))
            ends.append(tested.evidence.coefficients @ columns[found.kept])
        stacked.append(((ends[1] - ends[0]) / (2 * step))[None])
    return np.vstack(stacked)
