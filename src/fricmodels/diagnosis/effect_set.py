"""The effects that a residual suggests together, each beside those before it, and a description of what they leave."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.basis_functions import hats_within, one_torque_within
from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests, not_yet, tested_at
from fricmodels.diagnosis.floor import floor, leaves_nothing
from fricmodels.diagnosis.journal import searched
from fricmodels.diagnosis.places import largest_place
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE, ChannelPredictor, passing_predictors
from fricmodels.diagnosis.verdict import LookAlikes, select_effect
from fricmodels.term import Effect
from fricmodels.weakform.acting import acting
from fricmodels.weakform.directions import tangent, usual_step
from fricmodels.weakform.regression import Regression, compare
from fricmodels.weakform.shifted import regression_of

_DESCRIPTIONS = 2
"""Predictors that describe what a set of effects leaves."""


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


def found_in_turn(
    result: CandidateTests,
    leave_out: set[str],
    members: list[Member],
    description: Array,
    several: Collection[str] = (),
) -> list[Member]:
    """Return effects found one after the other, each beside those before it, until nothing is left to be explained.

    Args:
        result: the tests of all candidates.
        leave_out: effects that are not considered.
        members: what was found before.
        description: columns that describe the rest, shape (k, rows).
        several: kinds of effects of which another one is considered where one is there.
    """
    members = [*members]
    while len(members) < result.policy.most_together:
        columns = np.vstack([stacked(result, members), description])
        if float(np.sum(regression_beside(result, columns, members).loss)) <= floor(result.problem, result.policy):
            break
        if not len(columns):
            break  # all candidates were tested as they are, and none passes
        found = candidate_tests(
            result.problem,
            result.parameters,
            leave_out=leave_out,
            also=columns,
            found=[m.effect.name for m in members],
            several=several,
            policy=result.policy,
        )
        best = select_effect(found)
        if best is None:
            break
        members.append(member_of(found, best))
    return members


def member_of(result: CandidateTests, found: LookAlikes) -> Member:
    """Return an effect that was found as a member of a set."""
    return Member(found, columns_and_tangents(result, found.first))


def without_tangents(result: CandidateTests, member: Member, beside: Array) -> Iterator[Member]:
    """Yield a member with the columns of its equation alone: as it was found, then sought anew beside given columns.

    A tangent stands for a small change of a nonlinear parameter. Its coefficient has no bound: with a large one the
    columns add up to what the effect cannot be at any value. A wave and its tangent are a straight line, which no wave
    is.

    Args:
        result: the residual.
        member: an effect of the set; nothing is yielded for one that has no such parameter.
        beside: columns, shape (k, rows).
    """
    effect, first = member.effect, member.found.first
    if not len(first.found.nonlinear) or any(p.delay for p in effect.parameters):
        return
    yield replace(member, columns=first.found.columns)
    regression = regression_of(result.problem, result.parameters, beside)
    found = searched(result.problem, regression, effect, result.problem.alone(effect), 0.0)
    if found is not None and np.any(found.kept):
        yield Member(replace(member.found, first=tested_at(regression, effect, found)), found.columns)


def pruned(result: CandidateTests, members: list[Member]) -> list[Member]:
    """Remove what those found later have made superfluous: the first may have stood for several of them.

    What was removed is a look-alike of one that stays where it explains as much in its place. An effect at its search
    bound makes no other one superfluous: it describes what is missing, with tangents that have no bound, and is not it.
    """
    policy = result.policy
    least = policy.least_torque**2 * float(np.sum(acting(result.problem) ** 2))
    kept, removed = list(members), []
    while len(kept) > 1:
        gains = [gain_of(result, stacked(result, _rivals(kept, m)), m) for m in kept]
        weakest = min(range(len(kept)), key=lambda i: gains[i].fall)
        if gains[weakest].p_value < policy.significance and gains[weakest].fall > least:
            break
        removed.append(kept.pop(weakest))
    return [_with_look_alikes(result, m, _rivals(kept, m), removed) for m in kept] if removed else kept


def _rivals(members: list[Member], member: Member) -> list[Member]:
    """Return the others of a set that may make a member superfluous."""
    return [m for m in without(members, member) if member.at_bound or not m.at_bound]


def renumbered(result: CandidateTests, members: list[Member]) -> list[Member]:
    """Return members of a set, each kind numbered from the first on: what another one stood for may be gone."""
    there = {effect.name for effect in result.problem.drive.model.effects}
    changed = []
    for member in members:
        first, *alike = (_numbered(test, there) for test in (member.found.first, *member.found.members[1:]))
        same = first is member.found.first and all(a is b for a, b in zip(alike, member.found.members[1:], strict=True))
        changed.append(member if same else replace(member, found=LookAlikes(first, (first, *alike))))
        there.add(first.name)
    return changed


def _numbered(test: CandidateTest, there: set[str]) -> CandidateTest:
    """Return the test of an effect under the name that it has beside those that are there."""
    effect = next(not_yet([test.effect.first_of_kind()], there), test.effect)
    return test if effect.name == test.name else replace(test, effect=effect)


def without(members: list[Member], member: Member) -> list[Member]:
    """Return a set without one of its members."""
    return [m for m in members if m is not member]


def _with_look_alikes(result: CandidateTests, member: Member, others: list[Member], removed: list[Member]) -> Member:
    """Return a member of a set with those of the removed that explain as much as it does beside the others."""
    beside, found = stacked(result, others), member.found
    own = gain_of(result, beside, member)
    alike = []
    for one in removed:
        theirs = gain_of(result, beside, one)
        _, p_worse = compare(theirs.regression.loss, own.regression.loss, own.without.terms)
        if one.effect.name not in found.names and p_worse > result.policy.alike_significance:
            alike.append(one.found.first)
    return replace(member, found=LookAlikes(found.first, (*found.members, *alike))) if alike else member


@dataclass(frozen=True)
class Rest:
    """A description without physics of what a set of effects leaves.

    Attributes:
        parts: columns of each channel, shape (k, rows), the channel that predicts best first.
        lasting: of the past of the residual or of the torque, shape (k, rows). It shows all that lasts, whatever the
            cause: it sharpens the view of an effect, but does not take its place.
        channels: their names, the best first.
        unpredicted: sum of squares that is left where no channel predicts any of it, nor its own past; else zero.
        tried: number of predictors among which they were chosen.
    """

    parts: tuple[Array, ...]
    lasting: Array
    channels: tuple[str, ...] = ()
    unpredicted: float = 0.0
    tried: int = 1

    @classmethod
    def of(cls, result: CandidateTests, members: list[Member]) -> Rest:
        """Choose the channels, the best one first, then the best beside it; the past where no channel predicts."""
        policy = result.policy
        parts: tuple[Array, ...] = ()
        lasting = nothing(result)
        names: tuple[str, ...] = ()
        unpredicted, tried = 0.0, 1
        for _ in range(_DESCRIPTIONS):
            regression = regression_beside(result, np.vstack([stacked(result, members), *parts]), members)
            before = float(np.sum(regression.loss))
            if before <= floor(result.problem, result.policy):
                break
            passing = passing_beside(result, regression)
            unpredicted = 0.0 if passing else before
            sets = [p for p in passing if np.sum(p.evidence.loss) < (1 - policy.description_gain) * before]
            chosen = min(sets, key=lambda p: (p.channels in AUTOREGRESSIVE, p.evidence.left), default=None)
            if chosen is None:
                break
            names, tried = (*names, chosen.channels), chosen.tried
            if chosen.channels in AUTOREGRESSIVE:
                lasting = chosen.columns
                break
            parts = (*parts, chosen.columns)
        return cls(parts, lasting, names, unpredicted, tried)


@dataclass(frozen=True)
class Gain:
    """What an effect does beside given columns.

    Attributes:
        without, regression: the regression without the effect, and with it.
        columns: those of its columns that are visible there, shape (k, rows).
        torque: what it is there, shape (rows,).
        before, fall: sum of squared held-out residuals without it, and by how much it falls.
        p_value: of the Wald test of its columns.
    """

    without: Regression
    regression: Regression
    columns: Array
    torque: Array
    before: float
    fall: float
    p_value: float


def gain_of(result: CandidateTests, beside: Array, member: Member) -> Gain:
    """Return what a member does beside given columns, shape (k, rows)."""
    without = regression_of(result.problem, result.parameters, beside)
    shifts = any(p.delay for p in member.effect.parameters)
    delayed = regression_of(result.problem, result.parameters, beside, member.effect) if shifts else without
    visible = delayed.visible(member.columns)
    before = float(np.sum(without.loss))
    if not np.any(visible):
        return Gain(without, without, member.columns[:0], np.zeros(result.problem.rows), before, 0.0, 1.0)
    columns = member.columns[visible]
    evidence = delayed.test(columns, without)
    after = regression_of(result.problem, result.parameters, np.vstack([beside, member.columns]), member.effect)
    fall = before - float(np.sum(after.loss))
    return Gain(without, after, columns, evidence.coefficients @ columns, before, fall, evidence.p_value)


def the_past_counts(result: CandidateTests, member: Member, beside: Array) -> bool:
    """Whether the past of the residual or of the torque may stand in the place of an effect beside columns.

    It shows all that lasts, whatever its form, so that only an effect with memory, which may imitate what lasts, has to
    do more. Not one that leaves nothing above noise: in slow motion the past is all of any torque.
    """
    if not member.effect.states:
        return False
    gain = gain_of(result, beside, member)
    return not leaves_nothing(result.problem, gain.before, gain.before - gain.fall, result.policy)


def passing_beside(
    result: CandidateTests, regression: Regression, *, as_rivals: bool = False, planned: Collection[str] = ()
) -> list[ChannelPredictor]:
    """Return the channel predictors of what a regression leaves that pass all gates; with a place, what may be there.

    In a place there may be a torque of any course, or one torque: many terms, or few.

    Args:
        result: the residual.
        regression: the base model and what is beside it.
        as_rivals: whether they stand against an effect, see :func:`~.verdict.predicts`.
        planned: those that were chosen before any was tried, so that they are not corrected for how many there are.
    """
    here = replace(result, regression=regression, tested=(), untested={})
    found = passing_predictors(here, as_rivals=as_rivals, planned=planned)
    place = largest_place(here)
    if place is not None:
        tried = max((p.tried for p in found), default=1)
        for name, within in (("in places", hats_within), ("in one place", one_torque_within)):
            seen = visible_of(regression, within(result.problem, place))
            if len(seen):
                found.append(
                    ChannelPredictor(f"{place.channel}, {name}", regression.test(seen), place.p_value, seen, tried)
                )
    return found


def visible_of(regression: Regression, columns: Array) -> Array:
    """Return the columns that a regression can tell from what it has, shape (k, rows)."""
    return np.asarray(columns[regression.visible(columns)])


def regression_beside(result: CandidateTests, columns: Array, members: list[Member]) -> Regression:
    """Return the regression with columns, shape (k, rows), beside the model; a delay leaves it no shift of its own."""
    delayed = next((m.effect for m in members if any(p.delay for p in m.effect.parameters)), None)
    return regression_of(result.problem, result.parameters, columns, delayed)


def stacked(result: CandidateTests, members: list[Member]) -> Array:
    """Return the columns of all members, shape (k, rows)."""
    return np.vstack([nothing(result), *(m.columns for m in members)])


def nothing(result: CandidateTests) -> Array:
    """Return no columns, shape (0, rows)."""
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

    def torque(columns: Array, _: Array) -> Array:
        return np.asarray(tested.evidence.coefficients @ columns[found.kept])

    for i, value in enumerate(found.nonlinear):
        stacked.append(tangent(problem, alone, found.nonlinear, i, usual_step(value), torque)[None])
    return np.vstack(stacked)
