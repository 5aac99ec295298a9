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
   L is the sum of squared residuals, L_0 what noise and sampling leave. What e explains is what its equation can
   be, without the tangents of its nonlinear parameters.

A mimic fails one of these: what it explained is taken by R, or a channel predicts more. A true effect beside an unknown
cause passes: R takes the unknown part, and little remains but the effect's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.basis_functions import OF_POSITION, OF_TIME, OF_WAVES, terms
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.effect_set import (
    Gain,
    Member,
    Rest,
    found_in_turn,
    gain_of,
    member_of,
    nothing,
    passing_beside,
    pruned,
    renumbered,
    stacked,
    visible_of,
    without,
    without_tangents,
)
from fricmodels.diagnosis.floor import floor, share_explained
from fricmodels.diagnosis.look_ahead import set_ahead, set_beside
from fricmodels.diagnosis.one_cause import credited, is_drawn, is_simpler, predicts_beside, that_are_one_cause
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE
from fricmodels.diagnosis.verdict import LookAlikes, select_effect
from fricmodels.progress import each
from fricmodels.term import Effect
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Judgement:
    """The effects of a set, and what speaks for each.

    Attributes:
        members: each effect with its look-alikes, and what speaks for it; that which was found first comes first.
        one_cause: those that only imitate one unknown cause together.
        described_by: the channels that describe what the set leaves.
        only_jointly: whether none of the effects showed by itself: each is there only if the others are.
        floor, unpredicted: RMS torques that noise and sampling leave, and that nothing predicts, over the RMS torque.
    """

    members: tuple[tuple[LookAlikes, Support], ...]
    one_cause: tuple[LookAlikes, ...]
    described_by: tuple[str, ...]
    floor: float
    unpredicted: float
    only_jointly: bool = False

    def supported(self, policy: Policy) -> list[LookAlikes]:
        """Return the effects that are there."""
        large = [found for found, support in self.members if support.torque > policy.least_torque]
        return [found for found in large if self.stands(found.first, policy)]

    def stands(self, tested: CandidateTest, policy: Policy) -> bool:
        """Whether an effect of the set is there, however small in the rows."""
        own = [support for found, support in self.members if found.first is tested]
        imitates = any(found.first is tested for found in self.one_cause)
        return bool(own) and own[0].suffices(policy) and not imitates

    def contradicts(self, tested: CandidateTest, policy: Policy) -> bool:
        """Whether an effect of the set has another form than what is missing: a channel says so.

        A small share of what is left is no such thing: more may be missing.
        """
        own = [support for found, support in self.members if found.first is tested]
        return any(s.of_channel < policy.of_channel for s in own)


def judge(result: CandidateTests, leave_out: Iterable[str], first: LookAlikes | None) -> Judgement:
    """Find the set of effects, and judge each beside the others and a description of the rest.

    Args:
        result: the tests of all candidates.
        leave_out: effects that are not considered.
        first: the effect that explains the residual best, with its look-alikes; ``None`` where none passes by itself.
    """
    out, drive = set(leave_out), result.problem.drive
    # Several of a kind imitate anything together, as waves do a bump: others are sought once the first one stands.
    firsts = replace(result, tested=tuple(t for t in result.tested if not _is_further(t)))
    best = first if len(firsts.tested) == len(result.tested) else select_effect(firsts)
    members, rest = _set_of(firsts, out, best, set())
    judgement = _judged(firsts, members, rest)
    if not judgement.supported(result.policy):
        judgement = _looked_ahead(firsts, out, judgement, rest)
    several = _kinds([*drive.model.effects, *(found.first.effect for found in judgement.supported(result.policy))])
    if not several:
        return judgement
    further = _judged(result, *_set_of(result, out, first, several))
    return further if any(_is_further(found.first) for found in further.supported(result.policy)) else judgement


def _looked_ahead(result: CandidateTests, out: set[str], judgement: Judgement, rest: Rest) -> Judgement:
    """Return the judgement of a set that shows only once more is there; the given one where there is no such set.

    Effects may show beside the description of the rest, where it contradicts those that took its place in the set, or
    beside each other.
    """
    policy = result.policy
    contradicted = {found.first.name for found, _ in judgement.members if judgement.contradicts(found.first, policy)}
    beside = set_beside(result, out | contradicted, rest) if contradicted else []
    found = _judged(result, beside, rest) if beside else judgement
    if found.supported(policy):
        return found
    ahead = set_ahead(result, out, set())
    joint = _judged(result, ahead, Rest.of(result, ahead)) if ahead else judgement
    return replace(joint, only_jointly=True) if len(joint.supported(policy)) > 1 else judgement


def _kinds(effects: Iterable[Effect]) -> set[str]:
    """Return the kinds of effects of which a drive may have several."""
    return {effect.first_of_kind().name for effect in effects if effect.another() is not None}


def _is_further(test: CandidateTest) -> bool:
    """Whether an effect is another one of a kind of which a drive may have several."""
    return test.effect.first_of_kind().name != test.name


def _set_of(
    result: CandidateTests, out: set[str], first: LookAlikes | None, several: set[str]
) -> tuple[list[Member], Rest]:
    """Return a set of effects and a description of the rest; of the kinds in ``several`` others are considered."""
    begun = [] if first is None else [member_of(result, first)]
    members = found_in_turn(result, out, begun, nothing(result), several)
    rest = Rest.of(result, members)
    if rest.parts:  # what the rest hides shows beside a description of it
        members = found_in_turn(result, out, members, rest.parts[0], several)
        rest = Rest.of(result, members)
    return renumbered(result, pruned(result, members)), rest


def _judged(result: CandidateTests, members: list[Member], rest: Rest) -> Judgement:
    policy = result.policy
    # An effect at its search bound only resembles what is missing: it describes, and is not named.
    members, at_bound = [m for m in members if not m.at_bound], [m for m in members if m.at_bound]
    rest = replace(rest, parts=(*rest.parts, *(m.columns for m in at_bound)))
    kept = each("judging each effect beside the others", members)
    judged = [(m, _support(result, m, without(members, m), rest)) for m in kept]
    one_cause = that_are_one_cause(result, members, [m for m, s in judged if s.suffices(policy)])
    further = [m for m in members if _is_further(m.found.first)]
    # A series of waves draws one torque over position: it does not end, or takes more terms than that.
    if further and (not OF_POSITION.isdisjoint(rest.channels) or any(is_drawn(result, members, m) for m in further)):
        one_cause += further
    power = float(np.sum(result.problem.driving**2))
    return Judgement(
        tuple((m.found, support) for m, support in judged),
        tuple(m.found for m in one_cause),
        (*rest.channels, *(f"'{m.effect.name}' at its search bound" for m in at_bound)),
        float(np.sqrt(floor(result.problem, policy) / power)),
        float(np.sqrt(rest.unpredicted / power)),
    )


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


def _support(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> Support:
    beside = stacked(result, others)
    own = gain_of(result, beside, member).fall

    def in_its_place(columns: Array) -> bool:
        return gain_of(result, np.vstack([beside, columns]), member).fall < result.policy.kept * own

    names = (*rest.channels, *[""] * len(rest.parts))  # effects at their search bounds come last, and have none
    taking = {i: names[i] for i, part in enumerate(rest.parts) if in_its_place(part)}
    instead = _Instead(
        np.vstack([nothing(result), *(rest.parts[i] for i in taking)]),
        frozenset(taking.values()),
        rest.tried,
        sum(terms(name, rest.parts[i]) for i, name in taking.items()),
    )
    # An effect of the time itself beside one course of time could be any other: such a part describes no other cause.
    same = {i for i, name in enumerate(names) if member.effect.depends_on_time and name in OF_TIME}
    apart = [beside, *(part for i, part in enumerate(rest.parts) if i not in same.union(taking))]
    # What lasts counts against an effect with memory only: a delay is all that the torque's own past can be.
    counts = len(rest.lasting) and (bool(member.effect.states) or not in_its_place(rest.lasting))
    place = _Place(beside, np.vstack(apart), instead, rest.lasting if counts else nothing(result))
    found = _support_of(result, member, place)
    if not found.suffices(result.policy):
        return found
    # The Wald test keeps the tangents: they are what was sought besides.
    for one in without_tangents(result, member, place.base):
        found = replace(_support_of(result, one, place), p_value=found.p_value)
        if found.suffices(result.policy):
            break
    return found


@dataclass(frozen=True)
class _Instead:
    """What may be in the place of an effect.

    Attributes:
        columns: shape (k, rows); none where nothing is.
        channels: names of the channels that they are of.
        tried: number of predictors among which these were chosen.
        terms: number of their coefficients, and of what was sought beside these.
    """

    columns: Array
    channels: frozenset[str]
    tried: int
    terms: int


@dataclass(frozen=True)
class _Place:
    """Beside what an effect is judged, each as columns, shape (k, rows).

    Attributes:
        named: the other effects.
        base: these, and what describes the rest and is not in the place of this effect.
        instead: what describes the rest and is in its place.
        lasting: the past of the residual or of the torque, where it counts.
    """

    named: Array
    base: Array
    instead: _Instead
    lasting: Array


def _support_of(result: CandidateTests, member: Member, place: _Place) -> Support:
    described, of_rest, instead = gain_of(result, place.base, member), float("inf"), place.instead
    if len(instead.columns):
        other = regression_of(result.problem, result.parameters, np.vstack([place.base, instead.columns]))
        of_instead = described.before - float(np.sum(other.loss))
        ours, theirs = credited(result, described.before, described.fall, of_instead)
        first = member.found.first
        if theirs > ours and _is_better(result, first, described, ours / theirs, other, other.loss, instead):
            of_rest = ours / theirs
    lasting = place.lasting
    full = gain_of(result, np.vstack([place.base, lasting]), member) if len(lasting) else described
    found = Support(
        share_explained(result.problem, full.before, full.before - full.fall, result.policy),
        of_rest,
        float(np.sqrt(max(full.fall, 0.0) / np.sum(result.problem.driving**2))),
        full.p_value,
        "the description of the rest" if np.isfinite(of_rest) else "",
    )
    if not found.suffices(result.policy):
        return found  # no channel need be asked
    rivals = [_against_channels(result, described, member.found.first, place.base)]
    if len(place.base) > len(place.named):
        together = np.vstack([place.base, member.columns])[len(place.named) :]
        alone = gain_of(result, place.named, member)
        rivals.append(_against_channels(result, alone, member.found.first, place.named, together))
    of_channel, rival = min(rivals)
    return replace(found, of_channel=of_channel, rival=rival) if of_channel < of_rest else found


def _is_better(
    result: CandidateTests,
    effect: CandidateTest,
    gain: Gain,
    ratio: float,
    other: Regression,
    loss: Array,
    instead: _Instead,
) -> bool:
    """Whether what is in the place of an effect predicts clearly more than it.

    It does if it has no more terms: of two such forms the one that explains more is the better one, and no chance is to
    be allowed for. (The past of the residual or of the torque is no form.) Otherwise it does if the errors, compared as
    those of two forecasts, say so (Diebold and Mariano 1995). It also does if it predicts what the effect leaves, and
    the effect nothing of what it leaves (Chong and Hendry 1986): where an effect lies within what a channel can be,
    that is the test of its form, of which the errors tell little. Not so of waves at numbers that were sought: of
    several in one channel one may be the effect's, and the next another cause's.

    Args:
        result: the residual.
        effect: with its nonlinear parameters, each of which is a term.
        gain: what the effect does.
        ratio: of what it explains to what is explained in its place.
        other: the regression with that in its place.
        loss: its squared residuals, shape (rows,).
        instead: what is in its place.
    """
    policy = result.policy
    simple = instead.terms <= len(effect.found.columns) + len(effect.found.nonlinear)
    if simple and not instead.channels & AUTOREGRESSIVE:
        return True
    _, p_more = compare(gain.regression.loss, loss, gain.without.terms)
    if p_more * instead.tried <= policy.outpredicted_significance:
        return True
    if ratio >= policy.of_channel or instead.channels & OF_WAVES:
        return False
    adds = predicts_beside(result, gain.regression, instead.columns, instead.tried, policy.form_significance)
    return adds and not predicts_beside(result, other, gain.columns)


def _against_channels(
    result: CandidateTests, gain: Gain, first: CandidateTest, beside: Array, together: Array | None = None
) -> tuple[float, str]:
    """Return the least ratio of what an effect explains to what a channel explains that predicts clearly more, and it.

    The past of the residual or of the torque counts only against an effect with memory: it shows all that lasts. A
    channel beside which the effect still does most of what it does is another cause. Against an effect of the time
    itself, which happens once, other courses of time test the form: a comparison that was planned, not one of many.

    Args:
        result: the residual.
        gain: what the effect does beside the given columns.
        first: the effect.
        beside: these columns, shape (k, rows).
        together: columns of the effect and of a description of the rest. Then only a channel counts that explains as
            much as both do, with fewer terms.
    """
    policy, least, rival = result.policy, np.inf, ""
    planned = OF_TIME if first.effect.depends_on_time else ()
    for predictor in passing_beside(result, gain.without, as_rivals=True, planned=planned):
        if predictor.channels in AUTOREGRESSIVE and not first.effect.states:
            continue
        own, theirs = credited(result, gain.before, gain.fall, gain.before - float(np.sum(predictor.evidence.loss)))
        if own >= theirs:
            continue
        if together is not None and not is_simpler(result, gain.without, beside, together, predictor):
            continue
        both = gain.without.test(visible_of(gain.without, np.vstack([predictor.columns, gain.columns])))
        kept = float(np.sum(predictor.evidence.loss)) - float(np.sum(both.loss))
        if kept >= policy.kept * gain.fall or own / theirs >= least:
            continue
        other = regression_of(result.problem, result.parameters, np.vstack([beside, predictor.columns]))
        channels = frozenset({predictor.channels})
        instead = _Instead(predictor.columns, channels, predictor.tried, predictor.terms)
        if _is_better(result, first, gain, own / theirs, other, predictor.evidence.loss, instead):
            least, rival = own / theirs, predictor.channels
    return least, rival
