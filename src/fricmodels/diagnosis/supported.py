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
   be, without the tangents of its nonlinear parameters. Or e explains most of what S and all of R leave, L_0
   included: then both are there.

A mimic fails one of these: what it explained is taken by R, or a channel predicts more. A true effect beside an unknown
cause passes: R takes the unknown part, and little remains but the effect's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricmodels.diagnosis.basis_functions import OF_POSITION, OF_TIME, terms
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.effect_set import (
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
from fricmodels.diagnosis.one_cause import credited, is_drawn, is_simpler, that_are_one_cause
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE
from fricmodels.diagnosis.rivals import Instead, against_channels, is_better
from fricmodels.diagnosis.verdict import LookAlikes, is_large_over_all_motion, outside, select_effect
from fricmodels.diagnosis.walk import p_beside_a_walk, waves_of_friction
from fricmodels.progress import each
from fricmodels.term import Effect
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
        """Return the effects that are there; none that is there by itself is a look-alike of another one."""
        large = [found for found, support in self.members if support.is_large(policy)]
        there = [found for found in large if self.stands(found.first, policy)]
        firsts = {found.first.name for found in there}
        return [LookAlikes(f.first, tuple(t for t in f.members if t is f.first or t.name not in firsts)) for f in there]

    def unsure_of_its_share(self, policy: Policy) -> LookAlikes | None:
        """Return the first effect of a set of which none is there, if it only lacks its share, and nothing tells why.

        What neither a channel nor its own past predicts may be noise that was estimated too small.
        """
        if not self.members or not self.unpredicted or self.supported(policy):
            return None
        found, support = self.members[0]
        seen = found.first.once < policy.significance_once and support.is_large(policy)
        return found if seen and support.but_for_its_share(policy) else None

    def stands(self, tested: CandidateTest, policy: Policy) -> bool:
        """Whether an effect of the set is there, however small in the rows; it shows with what repeats counted once."""
        if tested.once >= policy.significance_once:
            return False
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
        tuple((_without_walks(result, m, without(members, m)), support) for m, support in judged),
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
        p_beside_walk: of an effect of the time itself, where friction may walk; 0 of any other.
        over_all_motion: whether it is large there, though small in the rows.
    """

    own_share: float
    of_channel: float
    torque: float
    p_value: float
    rival: str = ""
    p_beside_walk: float = 0.0
    over_all_motion: bool = False

    def is_large(self, policy: Policy) -> bool:
        """Whether the effect explains enough torque, of the rows or of all motion."""
        return self.torque > policy.least_torque or self.over_all_motion

    def suffices(self, policy: Policy) -> bool:
        """Whether the effect may be named, if it is large enough."""
        return self.own_share >= policy.own_share and self.but_for_its_share(policy)

    def but_for_its_share(self, policy: Policy) -> bool:
        """Whether it may be named if it explains most of what is left without it."""
        return (
            self.p_value < policy.significance
            and self.p_beside_walk < policy.walk_significance
            and self.of_channel >= policy.of_channel
        )


def _support(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> Support:
    """Return what speaks for a member of the set, given the others and a description of the rest."""
    found = _support_beside(result, member, others, rest)
    if not found.but_for_its_share(result.policy):
        return found
    if not found.is_large(result.policy):
        found = replace(found, over_all_motion=is_large_over_all_motion(result, member.found.first))
    return replace(found, p_beside_walk=_p_of_the_time(result, member, others))


def _support_beside(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> Support:
    beside = stacked(result, others)
    own = gain_of(result, beside, member).fall

    def in_its_place(columns: Array) -> bool:
        return gain_of(result, np.vstack([beside, columns]), member).fall < result.policy.kept * own

    names = (*rest.channels, *[""] * len(rest.parts))  # effects at their search bounds come last, and have none
    taking = {i: names[i] for i, part in enumerate(rest.parts) if in_its_place(part)}
    instead = Instead(
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
    lasting = rest.lasting if counts else nothing(result)
    if taking and not same:
        both = _beside_all(result, member, beside, rest, lasting)
        if both is not None:
            return both
    place = _Place(beside, np.vstack(apart), instead, lasting)
    found = _support_of(result, member, place)
    if not found.suffices(result.policy):
        return found
    # The Wald test keeps the tangents: they are what was sought besides.
    for one in without_tangents(result, member, place.base):
        found = replace(_support_of(result, one, place), p_value=found.p_value)
        if found.suffices(result.policy):
            break
    return found


def _beside_all(result: CandidateTests, member: Member, beside: Array, rest: Rest, lasting: Array) -> Support | None:
    """Return what speaks for an effect beside all that describes the rest, where it is there with that; else ``None``.

    A description may take most of what an effect explains and not be its form: two causes are there, and the channel
    of one has something of the other. Then the effect explains most of all that the description leaves, noise
    included, and is not all but within what the description can be. What only imitates a cause adds next to nothing
    to a description of it. And no other channel does by itself, with no more terms, what both do.

    Args:
        result: the residual.
        member: the effect.
        beside: the other effects as columns, shape (k, rows).
        rest: the description.
        lasting: the past of the residual or of the torque, where it counts, shape (k, rows).
    """
    policy, parts = result.policy, np.vstack(rest.parts)
    whole = np.vstack([beside, parts])
    gain = gain_of(result, np.vstack([whole, lasting]), member)
    if gain.fall < policy.own_share * gain.before or _lies_within(result, member, beside, parts):
        return None
    nobody = Instead(nothing(result), frozenset(), 1, 0)
    found = _support_of(result, member, _Place(whole, whole, nobody, lasting))
    if not found.suffices(policy) or found.torque <= policy.least_torque:
        return None
    alone, both = regression_of(result.problem, result.parameters, beside), np.vstack([parts, member.columns])
    simpler = (
        is_simpler(result, alone, beside, both, predictor, most=len(both))
        for predictor in passing_beside(result, alone, as_rivals=True)
        if predictor.channels not in AUTOREGRESSIVE.union(rest.channels)
    )
    return None if any(simpler) else found


def _lies_within(result: CandidateTests, member: Member, beside: Array, parts: Array) -> bool:
    """Whether nearly all of an effect's torque lies within columns, shape (k, rows), as seen beside others."""
    regression = regression_of(result.problem, result.parameters, beside)
    columns = visible_of(regression, member.found.first.found.columns)
    torque = regression.test(columns).coefficients @ columns if len(columns) else columns
    return not len(columns) or outside(regression, torque[None], visible_of(regression, parts)) < result.policy.own_form


def _without_walks(result: CandidateTests, member: Member, others: list[Member]) -> LookAlikes:
    """Return a class without those behind its first that a walk of friction may be as well."""

    def is_there(tested: CandidateTest) -> bool:
        if not tested.effect.depends_on_time:
            return True
        alone = member_of(result, LookAlikes(tested, (tested,)))
        return _p_of_the_time(result, alone, others) < result.policy.walk_significance

    first = member.found.first
    return LookAlikes(first, tuple(t for t in member.found.members if t is first or is_there(t)))


def _p_of_the_time(result: CandidateTests, member: Member, others: list[Member]) -> float:
    """Return the p-value of an effect of the time itself where friction may walk; 0 of any other effect.

    Others of the time are not beside it, nor is a description of the rest: they follow the walk, and hide it.
    """
    if not member.effect.depends_on_time:
        return 0.0
    beside = stacked(result, [other for other in others if not other.effect.depends_on_time])
    base = regression_of(result.problem, result.parameters, beside)
    p_value = p_beside_a_walk(base, waves_of_friction(result.problem), member.columns)
    return min(1.0, p_value * member.found.first.found.trials)


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
    instead: Instead
    lasting: Array


def _support_of(result: CandidateTests, member: Member, place: _Place) -> Support:
    described, of_rest, instead = gain_of(result, place.base, member), float("inf"), place.instead
    if len(instead.columns):
        other = regression_of(result.problem, result.parameters, np.vstack([place.base, instead.columns]))
        of_instead = described.before - float(np.sum(other.loss))
        ours, theirs = credited(result, described.before, described.fall, of_instead)
        first = member.found.first
        if theirs > ours and is_better(result, first, described, ours / theirs, other, other.loss, instead):
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
    if not found.but_for_its_share(result.policy):
        return found  # no channel need be asked
    rivals = [against_channels(result, described, member.found.first, place.base)]
    if len(place.base) > len(place.named):
        together = np.vstack([place.base, member.columns])[len(place.named) :]
        alone = gain_of(result, place.named, member)
        rivals.append(against_channels(result, alone, member.found.first, place.named, together))
    of_channel, rival = min(rivals)
    return replace(found, of_channel=of_channel, rival=rival) if of_channel < of_rest else found
