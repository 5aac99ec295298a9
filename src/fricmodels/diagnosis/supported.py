r"""Which of the effects that resemble a residual are there, whatever else is missing beside them.

Where the true cause is not among the candidates, some other effect still explains a part of it, significantly. Where
several causes act at once, a true effect explains only a part as well. What tells the two apart is what the effect
still does beside a description of the rest that assumes no physics:

1. Effects are found one after the other, each given those before, until none passes; these are the *set* S.
2. What S leaves is described by channel predictors R: flexible basis functions in the channels that predict it best.
   Effects that R uncovers join S; those that are too small beside the others leave it.
3. An effect e of S is *supported* if, given all the others and R, it explains most of what is left without it,

   .. math:: \frac{L(S \setminus e, R) - L(S, R)}{L(S \setminus e, R) - L_0} \ge \sigma,

   and if neither R nor any channel explains clearly more in the place of e. What does is in its place if e loses most
   of what it explains beside it; R then describes no other cause, and is left out of the formula.
   L is the sum of squared residuals on blocks that were not used for fitting, L_0 what noise and sampling leave.

A mimic fails one of these: what it explained is taken by R, or a channel predicts more. A true effect beside an unknown
cause passes: R takes the unknown part, and little remains but the effect's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.basis_functions import hats_over
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests
from fricmodels.diagnosis.floor import floor
from fricmodels.diagnosis.places import largest_place
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor, channel_predictors, each_predictor
from fricmodels.diagnosis.verdict import LookAlikes, predicts, select_effect
from fricmodels.term import Effect
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of

Array = NDArray[np.float64]

_DESCRIPTIONS = 2
"""Predictors that describe what a set of effects leaves."""
_RIVALS = 3
"""The best predictors of the whole residual that are asked whether they take the place of several effects."""
_WORTH = 0.05
"""A predictor joins the description if it lowers the sum of squares by this share."""


@dataclass(frozen=True)
class Member:
    """An effect of the set.

    Attributes:
        found: the effect with its look-alikes.
        columns: its columns and the tangents of its nonlinear parameters, shape (k, rows).
    """

    found: LookAlikes
    columns: Array

    @property
    def effect(self) -> Effect:
        """The effect itself."""
        return self.found.first.effect

    @property
    def at_bound(self) -> bool:
        """Whether it explains most at the end of what this recording can tell."""
        return self.found.first.found.at_search_bound


@dataclass(frozen=True)
class Judgement:
    """The effects of a set, and what speaks for each.

    Attributes:
        members: each effect with its look-alikes, and what speaks for it; that which was found first comes first.
        one_cause: those that only imitate one unknown cause together.
        described_by: the channels that describe what the set leaves.
        floor, unpredicted: RMS torques that noise and sampling leave, and that nothing predicts, over the RMS torque.
    """

    members: tuple[tuple[LookAlikes, Support], ...]
    one_cause: tuple[LookAlikes, ...]
    described_by: tuple[str, ...]
    floor: float
    unpredicted: float

    def supported(self, policy: Policy) -> list[LookAlikes]:
        """Return the effects that are there."""
        large = [found for found, support in self.members if support.torque > policy.least_torque]
        return [found for found in large if self.stands(found.first, policy)]

    def stands(self, tested: CandidateTest, policy: Policy) -> bool:
        """Whether an effect of the set is there, however small in the rows."""
        own = [support for found, support in self.members if found.first is tested]
        imitates = any(found.first is tested for found in self.one_cause)
        return bool(own) and own[0].suffices(policy) and not imitates


def judge(result: CandidateTests, leave_out: Iterable[str], first: LookAlikes | None) -> Judgement:
    """Find the set of effects, and judge each beside the others and a description of the rest.

    Args:
        result: the tests of all candidates.
        leave_out: effects that are not considered.
        first: the effect that explains the residual best, with its look-alikes; ``None`` where none passes by itself.
    """
    out, policy = set(leave_out), result.policy
    members = _found_in_turn(result, out, [] if first is None else [_member(result, first)], _nothing(result))
    rest = _Rest.of(result, members)
    if len(rest.best):  # what the rest hides shows beside a description of it
        hidden = _found_in_turn(result, out, members, rest.best)
        members, rest = hidden, _Rest.of(result, hidden)
    members = pruned(result, members)
    # An effect at its search bound only resembles what is missing: it describes, and is not named.
    members, at_bound = [m for m in members if not m.at_bound], [m for m in members if m.at_bound]
    rest = replace(rest, columns=np.vstack([rest.columns, *(m.columns for m in at_bound)]))
    judged = [(m, _support(result, m, _without(members, m), rest)) for m in members]
    one_cause = [m for m, s in judged if s.suffices(policy) and _one_cause(result, m, _without(members, m))]
    power = float(np.sum(result.problem.driving**2))
    return Judgement(
        tuple((m.found, support) for m, support in judged),
        tuple(m.found for m in one_cause),
        (*rest.channels, *(f"'{m.effect.name}' at its search bound" for m in at_bound)),
        float(np.sqrt(floor(result.problem, policy) / power)),
        float(np.sqrt(rest.unpredicted / power)),
    )


def supported(result: CandidateTests, leave_out: Iterable[str], first: LookAlikes | None) -> list[LookAlikes]:
    """Return the effects that are there, the one that was found first before the others; see :func:`judge`."""
    return judge(result, leave_out, first).supported(result.policy)


def passing_predictors(result: CandidateTests) -> list[ChannelPredictor]:
    """Return the channel predictors of the residual that pass all gates, best first."""
    return [p for p in channel_predictors(result) if predicts(result, p.evidence, p.p_value)]


def _found_in_turn(
    result: CandidateTests, leave_out: set[str], members: list[Member], description: Array
) -> list[Member]:
    """Return effects found one after the other, each beside those before it, until nothing is left to be explained.

    Args:
        result: the tests of all candidates.
        leave_out: effects that are not considered.
        members: what was found before.
        description: columns that describe the rest, shape (k, rows).
    """
    members = [*members]
    while len(members) < result.policy.most_together:
        columns = np.vstack([_stacked(result, members), description])
        if float(np.sum(_regression(result, columns, members).loss)) <= floor(result.problem, result.policy):
            break
        if not len(columns):
            break  # all candidates were tested as they are, and none passes
        out = leave_out | {m.effect.name for m in members}
        found = candidate_tests(result.problem, result.parameters, leave_out=out, also=columns, policy=result.policy)
        best = select_effect(found)
        if best is None:
            break
        members.append(_member(found, best))
    return members


def _member(result: CandidateTests, found: LookAlikes) -> Member:
    return Member(found, columns_and_tangents(result, found.first))


def pruned(result: CandidateTests, members: list[Member]) -> list[Member]:
    """Remove what those found later have made superfluous: the first may have stood for several of them.

    What was removed is a look-alike of one that stays where it explains as much in its place.
    """
    policy = result.policy
    least = policy.least_torque**2 * float(np.sum(result.problem.driving**2))
    kept, removed = list(members), []
    while len(kept) > 1:
        gains = [_gain(result, _stacked(result, _without(kept, m)), m) for m in kept]
        weakest = min(range(len(kept)), key=lambda i: gains[i].fall)
        if gains[weakest].p_value < policy.significance and gains[weakest].fall > least:
            break
        removed.append(kept.pop(weakest))
    return [_with_look_alikes(result, m, _without(kept, m), removed) for m in kept] if removed else kept


def _without(members: list[Member], member: Member) -> list[Member]:
    return [m for m in members if m is not member]


def _with_look_alikes(result: CandidateTests, member: Member, others: list[Member], removed: list[Member]) -> Member:
    """Return a member of a set with those of the removed that explain as much as it does beside the others."""
    beside, found = _stacked(result, others), member.found
    own = _gain(result, beside, member)
    alike = []
    for one in removed:
        theirs = _gain(result, beside, one)
        _, p_worse = compare(theirs.regression.loss, own.regression.loss, own.without.terms)
        if one.effect.name not in found.names and p_worse > result.policy.alike_significance:
            alike.append(one.found.first)
    return replace(member, found=LookAlikes(found.first, (*found.members, *alike))) if alike else member


@dataclass(frozen=True)
class _Rest:
    """A description without physics of what a set of effects leaves.

    Attributes:
        columns: of the channels, shape (k, rows).
        lasting: of the past of the residual or of the torque, shape (k, rows). It shows all that lasts, whatever the
            cause: it sharpens the view of an effect, but does not take its place.
        best: the columns of the channel that predicts best, shape (k, rows).
        channels: their names, the best first.
        unpredicted: sum of squares that is left where no channel predicts any of it, nor its own past; else zero.
    """

    columns: Array
    lasting: Array
    best: Array
    channels: tuple[str, ...] = ()
    unpredicted: float = 0.0

    @classmethod
    def of(cls, result: CandidateTests, members: list[Member]) -> _Rest:
        """Choose the channels, the best one first, then the best beside it; the past where no channel predicts."""
        columns = lasting = best = _nothing(result)
        names: tuple[str, ...] = ()
        unpredicted = 0.0
        for _ in range(_DESCRIPTIONS):
            regression = _regression(result, np.vstack([_stacked(result, members), columns]), members)
            before = float(np.sum(regression.loss))
            if before <= floor(result.problem, result.policy):
                break
            passing = _passing(result, regression)
            unpredicted = 0.0 if passing else before
            sets = [p for p in passing if np.sum(p.evidence.loss) < (1 - _WORTH) * before]
            chosen = min(sets, key=lambda p: (p.channels in AUTOREGRESSIVE, np.sum(p.evidence.loss)), default=None)
            if chosen is None:
                break
            names = (*names, chosen.channels)
            if chosen.channels in AUTOREGRESSIVE:
                lasting = chosen.columns
                break
            columns = np.vstack([columns, chosen.columns])
            best = best if len(best) else chosen.columns
        return cls(columns, lasting, best, names, unpredicted)


@dataclass(frozen=True)
class Support:
    """What speaks for an effect of a set, given the other effects and a description of the rest.

    Attributes:
        own_share: share of the squared residual above the floor that the effect explains.
        of_channel: least ratio of what it explains to what the description, or a channel that predicts clearly more,
            explains in its place.
        torque: RMS torque that only it explains, over the RMS torque.
        p_value: of the Wald test of its columns.
        rival: that channel; empty where none predicts clearly more.
    """

    own_share: float
    of_channel: float
    torque: float
    p_value: float
    rival: str = ""

    def suffices(self, policy: Policy) -> bool:
        """Whether the effect may be named, if it is large enough."""
        return (
            self.p_value < policy.significance
            and self.own_share >= policy.own_share
            and self.of_channel >= policy.of_channel
        )


def _support(result: CandidateTests, member: Member, others: list[Member], rest: _Rest) -> Support:
    beside = _stacked(result, others)
    alone = _gain(result, beside, member)
    described, of_rest = alone, float("inf")
    if len(rest.columns):
        described = _gain(result, np.vstack([beside, rest.columns]), member)
        if described.fall < result.policy.kept * alone.fall:  # the description takes its place
            theirs = alone.before - described.before
            described, of_rest = alone, alone.fall / theirs if theirs > 0 else of_rest
    full = described
    if len(rest.lasting):
        columns = rest.columns if described is not alone else rest.columns[:0]
        full = _gain(result, np.vstack([beside, columns, rest.lasting]), member)
    above = full.before - floor(result.problem, result.policy)
    of_channel, rival = min(
        (of_rest, "the description of the rest"), _against_channels(result, described, member.found.first)
    )
    return Support(
        full.fall / above if above > full.fall else 1.0,
        of_channel,
        float(np.sqrt(max(full.fall, 0.0) / np.sum(result.problem.driving**2))),
        full.p_value,
        rival if np.isfinite(of_channel) else "",
    )


def _one_cause(result: CandidateTests, member: Member, others: list[Member]) -> bool:
    """Whether one channel does by itself what several effects do together: then these imitate one unknown cause.

    Against the channel stand the effect and those others whose place the channel takes. They are several causes all the
    same if they explain as much with fewer than half of the channel's terms.
    """
    policy = result.policy
    lasting = AUTOREGRESSIVE if not member.effect.states else frozenset()
    for predictor in [p for p in passing_predictors(result) if p.channels not in lasting][:_RIVALS]:
        every = [*others, member]
        if not _takes_place(result, predictor, member, every):
            continue  # whatever else the channel does, it does not do what this effect does
        taken = [other for other in others if _takes_place(result, predictor, other, every)]
        if not taken:
            continue
        beside = _stacked(result, [other for other in others if other not in taken])
        before = _loss(result, beside)
        theirs = before - _loss(result, np.vstack([beside, predictor.columns]))
        group = np.vstack([member.columns, *(other.columns for other in taken)])
        together = before - _loss(result, np.vstack([beside, group]))
        if 2 * len(group) < len(predictor.columns) and together >= policy.of_channel * theirs:
            continue
        if before - _loss(result, np.vstack([beside, member.columns])) < policy.of_channel * theirs:
            return True
    return False


def _takes_place(result: CandidateTests, predictor: ChannelPredictor, member: Member, every: list[Member]) -> bool:
    """Whether a channel does most of what an effect does beside all the others."""
    beside = _stacked(result, [other for other in every if other is not member])
    own = _gain(result, beside, member).fall
    return _gain(result, np.vstack([beside, predictor.columns]), member).fall < result.policy.kept * own


def _loss(result: CandidateTests, columns: Array) -> float:
    return float(np.sum(regression_of(result.problem, result.parameters, columns).loss))


@dataclass(frozen=True)
class _Gain:
    """What an effect does beside given columns.

    Attributes:
        without, regression: the regression without the effect, and with it.
        before, fall: sum of squared held-out residuals without it, and by how much it falls.
        p_value: of the Wald test of its columns.
    """

    without: Regression
    regression: Regression
    columns: Array
    before: float
    fall: float
    p_value: float


def _gain(result: CandidateTests, beside: Array, member: Member) -> _Gain:
    without = regression_of(result.problem, result.parameters, beside)
    delayed = regression_of(result.problem, result.parameters, beside, member.effect)
    visible = delayed.visible(member.columns)
    before = float(np.sum(without.loss))
    if not np.any(visible):
        return _Gain(without, without, member.columns[:0], before, 0.0, 1.0)
    evidence = delayed.test(member.columns[visible], without)
    after = regression_of(result.problem, result.parameters, np.vstack([beside, member.columns]), member.effect)
    return _Gain(without, after, member.columns[visible], before, before - float(np.sum(after.loss)), evidence.p_value)


def _against_channels(result: CandidateTests, gain: _Gain, first: CandidateTest) -> tuple[float, str]:
    """Return the least ratio of what an effect explains to what a channel explains that predicts clearly more, and it.

    The past of the residual or of the torque counts only against an effect with memory: it shows all that lasts. A
    channel beside which the effect still does most of what it does is another cause.
    """
    policy, own, least, rival = result.policy, gain.fall, np.inf, ""
    for predictor in _passing(result, gain.without):
        if predictor.channels in AUTOREGRESSIVE and not first.effect.states:
            continue
        theirs = gain.before - float(np.sum(predictor.evidence.loss))
        if own >= theirs:
            continue
        if (
            compare(gain.regression.loss, predictor.evidence.loss, gain.without.terms)[1]
            > policy.outpredicted_significance
        ):
            continue
        both = gain.without.test(_visible(gain.without, np.vstack([predictor.columns, gain.columns])))
        beside = float(np.sum(predictor.evidence.loss)) - float(np.sum(both.loss))
        if beside < policy.kept * own and own / theirs < least:
            least, rival = own / theirs, predictor.channels
    return least, rival


def _passing(result: CandidateTests, regression: Regression) -> list[ChannelPredictor]:
    """Return the channel predictors of what a regression leaves that pass all gates; with a place, hats about it."""
    here = replace(result, regression=regression, tested=(), untested={})
    found = [p for p in each_predictor(here) if predicts(here, p.evidence, p.p_value)]
    place = largest_place(here)
    if place is not None:
        hats = hats_over(result.problem, place.channel, place.direction)
        seen = _visible(regression, hats)
        if len(seen):
            found.append(ChannelPredictor(f"{place.channel}, in places", regression.test(seen), place.p_value, seen))
    return found


def _visible(regression: Regression, columns: Array) -> Array:
    return np.asarray(columns[regression.visible(columns)])


def _regression(result: CandidateTests, columns: Array, members: list[Member]) -> Regression:
    delayed = next((m.effect for m in members if any(p.delay for p in m.effect.parameters)), None)
    return regression_of(result.problem, result.parameters, columns, delayed)


def _stacked(result: CandidateTests, members: list[Member]) -> Array:
    return np.vstack([_nothing(result), *(m.columns for m in members)])


def _nothing(result: CandidateTests) -> Array:
    return np.zeros((0, result.problem.rows))


def as_predictor(result: CandidateTests, tested: CandidateTest) -> ChannelPredictor:
    """Return an effect that is not what is missing as a predictor from the channels on which it depends."""
    needs = " and ".join(sorted(result.problem.alone(tested.effect).model.needs)).replace("_", " ")
    channels = "the course of the motion before" if tested.effect.states else needs or "a constant torque"
    columns = columns_and_tangents(result, tested)
    return ChannelPredictor(f"{channels}, as in '{tested.name}'", tested.evidence, tested.adjusted, columns)


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
