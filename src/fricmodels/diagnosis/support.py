r"""What speaks for one effect of a set, given the others and a description of the rest.

See :mod:`.supported` for the question, and for what a set and a description are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.basis_functions import OF_TIME, terms
from fricmodels.diagnosis.candidate_tests import CandidateTests
from fricmodels.diagnosis.effect_set import (
    Gain,
    Member,
    Rest,
    gain_of,
    nothing,
    passing_beside,
    stacked,
    the_past_counts,
    visible_of,
    without,
    without_tangents,
)
from fricmodels.diagnosis.floor import share_explained
from fricmodels.diagnosis.one_cause import credited, is_simpler
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE
from fricmodels.diagnosis.rivals import Instead, Outpredicted, against_channels, is_better
from fricmodels.diagnosis.verdict import is_large_over_all_motion, outside
from fricmodels.diagnosis.walk import p_beside_a_walk, waves_of_walks
from fricmodels.diagnosis.wave_form import any_form, has_another_form
from fricmodels.weakform.acting import acting
from fricmodels.weakform.shifted import regression_of


@dataclass(frozen=True)
class Support:
    """What speaks for an effect of a set, given the other effects and a description of the rest.

    Attributes:
        own_share: share of the squared residual above the floor that the effect explains.
        of_channel: least ratio of what it explains to what the description, or a channel that predicts clearly more,
            explains in its place.
        torque: RMS torque that only it explains, over the RMS torque.
        p_value: of the Wald test of its columns.
        p_beside_walk: where friction or zero may walk; 0 where that was not asked, as the effect is not there.
        over_all_motion: whether it is large there, though small in the rows.
        beside_one_channel: whether it stands in the place of one of the channels that describe the rest, beside the
            others: then it was asked already whether one of them is all of it.
        by_another_signal: whether what explains more is of signals that it is no function of, see
            :class:`.rivals.Outpredicted`.
        another_form: whether it is a wave, and what is there is that wave in another form; asked where all else holds.
    """

    own_share: float
    of_channel: float
    torque: float
    p_value: float
    p_beside_walk: float = 0.0
    over_all_motion: bool = False
    beside_one_channel: bool = False
    by_another_signal: bool = False
    another_form: bool = False

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
            and not self.is_outpredicted(policy)
            and not self.another_form
        )

    def is_outpredicted(self, policy: Policy) -> bool:
        """Whether a channel explains so much more in its place that the cause is another one."""
        return self.by_another_signal or self.of_channel < policy.of_channel


def support_of(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> Support:
    """Return what speaks for a member of the set, given the others and a description of the rest."""
    found = _support_beside(result, member, others, rest)
    if not found.but_for_its_share(result.policy):
        return found
    if not found.is_large(result.policy):
        found = replace(found, over_all_motion=is_large_over_all_motion(result, member.found.first))
    found = replace(found, p_beside_walk=p_beside_walk(result, member, others, rest))
    if not found.suffices(result.policy):
        return found
    return replace(found, another_form=_is_a_wave_of_another_form(result, member, others))


def _is_a_wave_of_another_form(result: CandidateTests, member: Member, others: list[Member]) -> bool:
    """Whether a member is a wave whose number was sought, and what is there is that wave in another form."""
    found, effect = member.found.first.found, member.effect
    linear = result.problem.alone(effect).model.linear
    if [p.periodic for p, is_linear in zip(effect.parameters, linear, strict=True) if not is_linear] != [True]:
        return False
    gain = gain_of(result, stacked(result, others), member)
    columns = any_form(result.problem, found.nonlinear[0])
    return has_another_form(gain.without, gain.regression.loss, columns, result.policy)


def _support_beside(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> Support:
    beside = stacked(result, others)
    own = gain_of(result, beside, member)

    def in_its_place(columns: Array) -> bool:
        return gain_of(result, np.vstack([beside, columns]), member).fall < result.policy.kept * own.fall

    names = (*rest.channels, *[""] * len(rest.parts))  # effects at their search bounds come last, and have none
    taking = {i: names[i] for i, part in enumerate(rest.parts) if in_its_place(part)}
    # An effect of the time itself beside one course of time could be any other: such a part describes no other cause.
    same = {i for i, name in enumerate(names) if member.effect.depends_on_time and name in OF_TIME}
    apart = [beside, *(part for i, part in enumerate(rest.parts) if i not in same.union(taking))]
    lasting = rest.lasting
    if len(lasting) and in_its_place(lasting) and not the_past_counts(result, member, np.vstack(apart)):
        lasting = nothing(result)  # it can be all that the effect is, and says nothing of it
    if taking and not same:
        both = _beside_all(result, member, own, beside, rest, lasting)
        if both is not None:
            return both
    place = _Place(beside, np.vstack(apart), _instead(result, rest, taking), lasting)
    found = _in(result, member, place)
    if found.suffices(result.policy) or len(taking) < 2:
        return found
    return _beside_one_channel(result, member, own, place, rest, taking) or found


def _instead(result: CandidateTests, rest: Rest, taking: Mapping[int, str]) -> Instead:
    """Return parts of a description, place → channel, as what may be in the place of an effect."""
    return Instead(
        np.vstack([nothing(result), *(rest.parts[i] for i in taking)]),
        frozenset(taking.values()),
        rest.tried,
        sum(terms(name, rest.parts[i]) for i, name in taking.items()),
    )


def _in(result: CandidateTests, member: Member, place: _Place) -> Support:
    """Return what speaks for an effect in a place, at best without the tangents of its nonlinear parameters."""
    found = _support_of(result, member, place)
    if not found.suffices(result.policy):
        return found
    # The Wald test keeps the tangents: they are what was sought besides.
    for one in without_tangents(result, member, place.base):
        found = replace(_support_of(result, one, place), p_value=found.p_value)
        if found.suffices(result.policy):
            break
    return found


def _beside_one_channel(
    result: CandidateTests, member: Member, own: Gain, place: _Place, rest: Rest, taking: Mapping[int, str]
) -> Support | None:
    """Return what speaks for an effect in the place of one channel, beside the other; ``None`` where nothing does.

    Where two channels are in the place of an effect they may describe two causes, of which the effect is one: it is
    that if, beside the channel of the other one, it does as much as its own channel, and keeps its size. Found beside
    nothing, its nonlinear parameters had to stand for both causes. So they are sought anew.
    """
    for i, name in taking.items():
        base = np.vstack([place.base, *(rest.parts[j] for j in taking if j != i)])
        here = replace(place, base=base, instead=_instead(result, rest, {i: name}))
        for one in (member, *without_tangents(result, member, base)):
            found = _support_of(result, one, here)
            if found.suffices(result.policy) and _keeps_its_size(result, own, gain_of(result, base, one), place.named):
                return replace(found, beside_one_channel=True)
    return None


def _beside_all(
    result: CandidateTests, member: Member, own: Gain, beside: Array, rest: Rest, lasting: Array
) -> Support | None:
    """Return what speaks for an effect beside all that describes the rest, where it is there with that; else ``None``.

    A description may take most of what an effect explains and not be its form: two causes are there, and the channel
    of one has something of the other. Then the effect explains most of all that the description leaves, noise
    included, and is not all but within what the description can be. What only imitates a cause adds next to nothing
    to a description of it, and does not keep its size beside that. And no other channel does by itself, with no more
    terms, what both do.

    Args:
        result: the residual.
        member: the effect.
        own: what it does beside the other effects alone.
        beside: the other effects as columns, shape (k, rows).
        rest: the description.
        lasting: the past of the residual or of the torque, where it counts, shape (k, rows).
    """
    policy, parts = result.policy, np.vstack(rest.parts)
    whole = np.vstack([beside, parts])
    gain = gain_of(result, np.vstack([whole, lasting]), member)
    if gain.fall < policy.own_share * gain.before or _lies_within(result, member, beside, parts):
        return None
    if not _keeps_its_size(result, own, gain, beside):
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


def _keeps_its_size(result: CandidateTests, own: Gain, described: Gain, beside: Array) -> bool:
    """Whether an effect has some of the size beside a description that it has beside the other effects alone.

    A cause that is not described gives an effect that is there another size, and where it is the larger one the other
    sign: an offset beside a torque of |acceleration| is positive by itself and negative beside that. What only imitates
    that cause has the size of the imitation, and next to none beside a description of it, of either sign: what it then
    explains is what the description leaves of its own form. The size is what it is along its own torque, without what
    the base model and the other effects, shape (k, rows), could be.
    """
    alone = regression_of(result.problem, result.parameters, beside)
    before, after = alone.project_out(np.stack([own.torque, described.torque]))
    return abs(float(after @ before)) >= result.policy.own_size * float(before @ before)


def _lies_within(result: CandidateTests, member: Member, beside: Array, parts: Array) -> bool:
    """Whether nearly all of an effect's torque lies within columns, shape (k, rows), as seen beside others."""
    regression = regression_of(result.problem, result.parameters, beside)
    columns = visible_of(regression, member.found.first.found.columns)
    torque = regression.test(columns).coefficients @ columns if len(columns) else columns
    return not len(columns) or outside(regression, torque[None], visible_of(regression, parts)) < result.policy.own_form


def p_beside_walk(result: CandidateTests, member: Member, others: list[Member], rest: Rest) -> float:
    """Return the p-value of an effect where friction or zero may walk.

    What may follow a walk, and hide it, is not beside it: an effect of the time that a walk may be as well, and a
    channel of the rest that leaves no less than the waves of walks do. One that leaves less is what is there, or in the
    place of the effect: with it and without it, the lesser p-value counts twice.
    """
    effect, waves = member.effect, waves_of_walks(result.problem)

    def is_no_walk(other: Member) -> bool:
        if not other.effect.depends_on_time:
            return True
        besides = without([*others, member], other)
        if effect.depends_on_time:
            return False
        return p_beside_walk(result, other, besides, rest) < result.policy.walk_significance

    beside = stacked(result, [other for other in others if is_no_walk(other)])
    found = _p_beside_walk(result, member, beside, waves)
    described = [*_that_are_no_walk(result, member, beside, waves, rest)]
    if not described:
        return found
    return min(1.0, 2.0 * found, 2.0 * _p_beside_walk(result, member, np.vstack([beside, *described]), waves))


def _p_beside_walk(result: CandidateTests, member: Member, beside: Array, waves: Array) -> float:
    """Return the p-value of an effect beside given columns where friction or zero may walk.

    An effect of the time itself shows in slow waves over the record only. Any other one is there where nothing is seen
    to walk, or if it shows in them, or outside of them: the lesser p-value counts twice.
    """
    effect, trials = member.effect, member.found.first.found.trials
    base = regression_of(result.problem, result.parameters, beside)
    evidence = None if effect.depends_on_time else result.policy.walk_evidence
    within = trials * p_beside_a_walk(base, waves, member.columns, evidence=evidence)
    if effect.depends_on_time or 2.0 * within < result.policy.walk_significance:
        return min(1.0, within)
    outside = gain_of(result, np.vstack([beside, visible_of(base, waves)]), member).p_value
    return min(1.0, 2.0 * within, 2.0 * outside)


def _that_are_no_walk(
    result: CandidateTests, member: Member, beside: Array, waves: Array, rest: Rest
) -> Iterator[Array]:
    """Yield the parts of a description of the rest that leave less than all the waves of walks do, with fewer terms."""
    parts = [p for name, p in zip(rest.channels, rest.parts, strict=False) if name not in OF_TIME]
    if not parts:
        return
    base = regression_of(result.problem, result.parameters, np.vstack([beside, member.columns]))

    def left(columns: Array) -> float:
        seen = visible_of(base, columns)
        return float(np.sum(base.test(seen).loss)) if len(seen) else float("inf")

    walking = left(waves)
    yield from (part for part in parts if len(part) < len(waves) and left(part) < walking)


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
    described, of_rest, instead = gain_of(result, place.base, member), Outpredicted(), place.instead
    if len(instead.columns):
        other = regression_of(result.problem, result.parameters, np.vstack([place.base, instead.columns]))
        of_instead = described.before - float(np.sum(other.loss))
        ours, theirs = credited(result, described.before, described.fall, of_instead)
        first = member.found.first
        if theirs > ours and is_better(result, first, described, ours / theirs, other, other.loss, instead):
            of_rest = Outpredicted(ours / theirs)
    lasting = place.lasting
    full = gain_of(result, np.vstack([place.base, lasting]), member) if len(lasting) else described
    found = Support(
        share_explained(result.problem, full.before, full.before - full.fall, result.policy),
        of_rest.ratio,
        float(np.sqrt(max(full.fall, 0.0) / np.sum(acting(result.problem) ** 2))),
        full.p_value,
    )
    if not found.but_for_its_share(result.policy):
        return found  # no channel need be asked
    rival = of_rest.or_by(against_channels(result, described, member.found, place.base))
    if len(place.base) > len(place.named):
        together = np.vstack([place.base, member.columns])[len(place.named) :]
        alone = gain_of(result, place.named, member)
        rival = rival.or_by(against_channels(result, alone, member.found, place.named, together))
    return replace(found, of_channel=rival.ratio, by_another_signal=rival.by_another_signal)
