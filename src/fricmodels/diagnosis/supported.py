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
   included: then both are there. Or e, sought anew beside one of two channels in R, does as much as the other channel:
   that described e.

4. Supported effects are judged once more without those that are not: these are no part of the set.

A mimic fails one of these: what it explained is taken by R, or a channel predicts more. A true effect beside an unknown
cause passes: R takes the unknown part, and little remains but the effect's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.diagnosis.basis_functions import OF_POSITION
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests
from fricmodels.diagnosis.effect_set import (
    Member,
    Rest,
    found_in_turn,
    member_of,
    nothing,
    pruned,
    renumbered,
    without,
)
from fricmodels.diagnosis.floor import floor
from fricmodels.diagnosis.look_ahead import set_ahead, set_beside
from fricmodels.diagnosis.one_cause import is_drawn, that_are_one_cause
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.support import Support, p_beside_walk, support_of
from fricmodels.diagnosis.verdict import LookAlikes, select_effect
from fricmodels.progress import each
from fricmodels.term import Effect
from fricmodels.weakform.acting import acting


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

    def only_walks(self, policy: Policy) -> set[str]:
        """Return the effects of the time that a walk is as well, and that have look-alikes of another kind."""
        return {
            found.first.name
            for found, support in self.members
            if found.first.effect.depends_on_time
            and support.p_beside_walk >= policy.walk_significance
            and replace(support, p_beside_walk=0.0).suffices(policy)
            and not all(tested.effect.depends_on_time for tested in found.members)
        }

    def unsure_of_its_share(self, policy: Policy) -> LookAlikes | None:
        """Return the first effect of a set of which none is there, if it only lacks its share, and nothing tells why.

        What neither a channel nor its own past predicts may be noise that was estimated too small. What imitates an
        unknown cause with others lacks more than its share.
        """
        if not self.members or not self.unpredicted or self.supported(policy):
            return None
        found, support = self.members[0]
        if self.imitates(found.first):
            return None
        seen = found.first.once < policy.significance_once and support.is_large(policy)
        return found if seen and support.but_for_its_share(policy) else None

    def stands(self, tested: CandidateTest, policy: Policy) -> bool:
        """Whether an effect of the set is there, however small in the rows; it shows with what repeats counted once."""
        if tested.once >= policy.significance_once:
            return False
        own = [support for found, support in self.members if found.first is tested]
        return bool(own) and own[0].suffices(policy) and not self.imitates(tested)

    def imitates(self, tested: CandidateTest) -> bool:
        """Whether an effect of the set only imitates one unknown cause together with others."""
        return any(found.first is tested for found in self.one_cause)

    def contradicts(self, tested: CandidateTest, policy: Policy) -> bool:
        """Whether an effect of the set has another form than what is missing: a channel says so.

        A small share of what is left is no such thing: more may be missing.
        """
        own = [support for found, support in self.members if found.first is tested]
        return any(support.is_outpredicted(policy) for support in own)


def judge(
    result: CandidateTests, leave_out: Iterable[str], first: LookAlikes | None, *, look_ahead: bool = True
) -> Judgement:
    """Find the set of effects, and judge each beside the others and a description of the rest.

    Args:
        result: the tests of all candidates.
        leave_out: effects that are not considered.
        first: the effect that explains the residual best, with its look-alikes; ``None`` where none passes by itself.
        look_ahead: whether sets are sought of which none shows by itself, where no effect stands; that takes as long as
            all the rest, and more.
    """
    out, drive = set(leave_out), result.problem.drive
    # Several of a kind imitate anything together, as waves do a bump: others are sought once the first one stands.
    firsts = replace(result, tested=tuple(t for t in result.tested if not _is_further(t)))
    best = first if len(firsts.tested) == len(result.tested) else select_effect(firsts)
    members, rest = _set_of(firsts, out, best, set())
    judgement = _judged(firsts, members, rest)
    if not judgement.supported(result.policy):
        walks = judgement.only_walks(result.policy)
        if walks:  # what they are look-alikes of may be there
            lasting = replace(result, tested=tuple(t for t in result.tested if t.name not in walks))
            return judge(lasting, out | walks, select_effect(lasting), look_ahead=look_ahead)
        judgement = _looked_ahead(firsts, out, judgement, rest) if look_ahead else judgement
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
    ahead = set_ahead(result, out)
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
    """Judge each effect of a set. Those that stand must do so without those that do not, too.

    Beside effects that are not there, which describe some of an unknown cause, another one may do as much of what they
    leave as a channel does. Without them it is that effect, and the channel, that are asked for all of it.
    """
    found = _judged_at_once(result, members, rest)
    standing = {one.first.name for one, _ in found.members if found.stands(one.first, result.policy)}
    there = [m for m in members if m.found.first.name in standing]
    if not there or len(there) == len(found.members):
        return found
    alone = _judged(result, there, Rest.of(result, there))
    again = {one.first.name: support for one, support in alone.members}
    members_again = tuple((one, again.get(one.first.name, support)) for one, support in found.members)
    imitating = {one.first.name for one in alone.one_cause}
    one_cause = (*found.one_cause, *(one for one, _ in found.members if one.first.name in imitating))
    return replace(found, members=members_again, one_cause=one_cause)


def _judged_at_once(result: CandidateTests, members: list[Member], rest: Rest) -> Judgement:
    policy = result.policy
    # An effect at its search bound only resembles what is missing: it describes, and is not named.
    members, at_bound = [m for m in members if not m.at_bound], [m for m in members if m.at_bound]
    rest = replace(rest, parts=(*rest.parts, *(m.columns for m in at_bound)))
    kept = each("judging each effect beside the others", members)
    judged = [(m, support_of(result, m, without(members, m), rest)) for m in kept]
    standing = [m for m, s in judged if s.suffices(policy) and not s.beside_one_channel]
    one_cause = that_are_one_cause(result, members, standing)
    further = [m for m in members if _is_further(m.found.first)]
    # A series of waves draws one torque over position: it does not end, or takes more terms than that.
    if further and (not OF_POSITION.isdisjoint(rest.channels) or any(is_drawn(result, members, m) for m in further)):
        one_cause += further
    power = float(np.sum(acting(result.problem) ** 2))
    return Judgement(
        tuple((_without_walks(result, m, without(members, m), rest), support) for m, support in judged),
        tuple(m.found for m in one_cause),
        (*rest.channels, *(f"'{m.effect.name}' at its search bound" for m in at_bound)),
        float(np.sqrt(floor(result.problem, policy) / power)),
        float(np.sqrt(rest.unpredicted / power)),
    )


def _without_walks(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> LookAlikes:
    """Return a class without those behind its first that a walk of friction may be as well."""

    def is_there(tested: CandidateTest) -> bool:
        if not tested.effect.depends_on_time:
            return True
        alone = member_of(result, LookAlikes(tested, (tested,)))
        return p_beside_walk(result, alone, others, rest) < result.policy.walk_significance

    first = member.found.first
    return LookAlikes(first, tuple(t for t in member.found.members if t is first or is_there(t)))
