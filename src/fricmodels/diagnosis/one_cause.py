"""Whether several effects, or an effect and a description of the rest, only imitate one unknown cause together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.basis_functions import OF_WAVES
from fricmodels.diagnosis.candidate_tests import CandidateTests
from fricmodels.diagnosis.effect_set import (
    Member,
    gain_of,
    passing_beside,
    stacked,
    the_past_counts,
    visible_of,
    without,
)
from fricmodels.diagnosis.floor import above_noise, creditable
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor
from fricmodels.diagnosis.verdict import predicts
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of

_RIVALS = 4
"""The best predictors of the whole residual, of which a place is two, that are asked whether they take the place of
several effects."""


def that_are_one_cause(result: CandidateTests, members: list[Member], standing: list[Member]) -> list[Member]:
    """Return those of the standing effects of a set that only imitate one unknown cause with others of the set."""
    if len(members) < 2 or not standing:
        return []
    channels = sorted(passing_beside(result, result.regression, as_rivals=True), key=lambda p: p.evidence.left)
    return [m for m in standing if _is_one_cause(result, m, without(members, m), channels)]


def _is_one_cause(
    result: CandidateTests, member: Member, others: list[Member], channels: list[ChannelPredictor]
) -> bool:
    """Whether one channel does by itself what several effects do together: then these imitate one unknown cause.

    Against the channel stand the effect and those others whose place it takes. If the effect does as much by itself,
    with no more terms, it needs none of them. They are one cause if the channel does as much with fewer terms than they
    have. Else they are several causes if they explain more with fewer terms, or as much with far fewer, or encompass it
    (Chong and Hendry 1986): beside them it predicts nothing that counts, and beside it they do. Load torque and
    direction hold friction of the load and an asymmetry both, but know neither's form; a channel of the position is all
    that two waves over it can be. The past of the residual or of the torque is asked only where
    :func:`.effect_set.the_past_counts`, and is one cause only if it does more than the effects together by a gain that
    counts.
    """
    policy = result.policy
    out = frozenset() if the_past_counts(result, member, stacked(result, others)) else AUTOREGRESSIVE
    for predictor in [p for p in channels if p.channels not in out][:_RIVALS]:
        every = [*others, member]
        if not _takes_place(result, predictor, member, every):
            continue  # whatever else the channel does, it does not do what this effect does
        taken = [
            other
            for other in others
            if not _are_of_a_kind(other, member) and _takes_place(result, predictor, other, every)
        ]
        if not taken or (predictor.channels in OF_WAVES and all(_is_a_wave(other) for other in (member, *taken))):
            continue  # several waves at numbers that were sought are what several effects are
        beside = stacked(result, [other for other in others if other not in taken])
        base, channel, alone, together = (
            regression_of(result.problem, result.parameters, np.vstack([beside, *columns]))
            for columns in (
                (),
                (predictor.columns,),
                (member.columns,),
                (member.columns, *(other.columns for other in taken)),
            )
        )
        before = float(np.sum(base.loss))
        falls = (before - float(np.sum(r.loss)) for r in (channel, alone, together))
        theirs, own, all_own = credited(result, before, *falls)
        if len(member.columns) <= predictor.terms and own >= policy.of_channel * theirs:
            continue  # it needs no other effect to do what the channel does
        if predictor.channels in AUTOREGRESSIVE and all_own >= (1.0 - policy.least_gain) * theirs:
            continue  # all that lasts has causes; these leave next to nothing of it
        effects = np.vstack([member.columns, *(other.columns for other in taken)])
        if predictor.terms < len(effects) and theirs >= policy.of_channel * all_own:
            return True
        if len(effects) < predictor.terms and theirs < policy.of_channel * all_own:
            continue  # the channel takes more terms and does less
        if all_own >= policy.of_channel * theirs:
            few = len(effects) < policy.fewer_terms * predictor.terms or (
                len(effects) < predictor.terms and _leave_nothing(result, together, [member, *taken], every)
            )
            adds = predicts_beside(result, together, predictor.columns, predictor.tried)
            if few or (not adds and predicts_beside(result, channel, effects)):
                continue
        _, p_more = compare(alone.loss, channel.loss, base.terms)
        if own < policy.of_channel * theirs and p_more * predictor.tried <= policy.outpredicted_significance:
            return True
    return False


def _leave_nothing(result: CandidateTests, together: Regression, effects: list[Member], every: list[Member]) -> bool:
    """Whether a set leaves nothing above noise of what even the least of some effects of it explains."""
    left = above_noise(result.problem, float(np.sum(together.loss)), result.policy)
    falls = (gain_of(result, stacked(result, without(every, one)), one).fall for one in effects)
    return left <= result.policy.least_gain * min(falls)


def is_drawn(result: CandidateTests, members: list[Member], member: Member) -> bool:
    """Whether effects of a kind draw a shape: slow waves, or what one channel explains as well with fewer terms."""
    kind = [m for m in members if _are_of_a_kind(m, member)]
    if _are_slow_waves(result, kind):
        return True
    beside, together = stacked(result, [m for m in members if m not in kind]), stacked(result, kind)
    alone = regression_of(result.problem, result.parameters, beside)
    return any(
        p.channels not in AUTOREGRESSIVE and is_simpler(result, alone, beside, together, p)
        for p in passing_beside(result, alone, as_rivals=True)
    )


def is_simpler(
    result: CandidateTests,
    alone: Regression,
    beside: Array,
    together: Array,
    predictor: ChannelPredictor,
    most: int | None = None,
) -> bool:
    """Whether a channel explains as much as columns, shape (k, rows), do together beside others, with fewer terms.

    Not if it is several waves itself: these are what several effects are. ``most`` is how many terms it may have, if
    not fewer than there are columns.
    """
    if predictor.terms > (len(together) - 1 if most is None else most) or predictor.channels in OF_WAVES:
        return False
    all_of_them = regression_of(result.problem, result.parameters, np.vstack([beside, together]))
    before = float(np.sum(alone.loss))
    falls = (before - float(np.sum(loss)) for loss in (predictor.evidence.loss, all_of_them.loss))
    theirs, ours = credited(result, before, *falls)
    return theirs >= result.policy.of_channel * ours


def _is_a_wave(member: Member) -> bool:
    """Whether an effect is periodic in position, at a number that was sought."""
    return any(p.periodic for p in member.effect.parameters)


def _are_of_a_kind(one: Member, other: Member) -> bool:
    """Whether two effects are of one kind: each was judged when the other was not yet considered."""
    return one.effect.first_of_kind().name == other.effect.first_of_kind().name


def predicts_beside(
    result: CandidateTests, regression: Regression, columns: Array, tried: int = 1, level: float = 1.0
) -> bool:
    """Whether columns predict what a regression leaves, as any channel has to that is to count, and at a level."""
    seen = visible_of(regression, columns)
    if not len(seen):
        return False
    evidence = regression.test(seen)
    p_value = min(1.0, evidence.p_value * tried)
    return p_value < level and predicts(replace(result, regression=regression), evidence, p_value, as_rival=True)


def _takes_place(result: CandidateTests, predictor: ChannelPredictor, member: Member, every: list[Member]) -> bool:
    """Whether a channel does most of what an effect does beside all the others."""
    beside = stacked(result, [other for other in every if other is not member])
    own = gain_of(result, beside, member).fall
    return gain_of(result, np.vstack([beside, predictor.columns]), member).fall < result.policy.kept * own


def _are_slow_waves(result: CandidateTests, kind: list[Member]) -> bool:
    """Whether more than one wave of a kind passes few periods in the travel, those of the model included."""
    name = kind[0].effect.first_of_kind().name
    effects = [e for e in result.problem.drive.model.effects if e.first_of_kind().name == name]
    known = [result.parameters[f"{e.name}.{p.symbol}"] for e in effects for p in e.parameters if p.periodic]
    waves = [*known, *(k for m in kind if _is_a_wave(m) for k in m.found.first.found.nonlinear)]
    if not waves:
        return False
    slow = 2.0 * np.pi * result.policy.wave_periods / float(np.ptp(result.problem.recording["position"]))
    return sum(k < slow for k in waves) > 1


def credited(result: CandidateTests, before: float, *falls: float) -> tuple[float, ...]:
    """Return falls of the squared residual as far as they may be credited to an effect or a channel."""
    return tuple(creditable(result.problem, before, fall, result.policy) for fall in falls)
