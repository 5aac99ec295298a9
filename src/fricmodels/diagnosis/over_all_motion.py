"""Whether a channel contradicts, over all motion, an effect that the rows of the weak form show.

The rows leave out where it is not certain how a drive moved, about every reversal. What they hold may be a part in
which two torques are alike: while a drive goes on at nearly one torque, a gain of the torque and a torque that falls
short of the current are one. Over all motion they are not. So an effect that the rows show is judged there once more
as in the rows: beside the other effects and a description of what they leave. It is not what is missing if it explains
most of that, and a channel clearly more. If it explains little there, something else acts about the reversals, of which
sampling alone makes some; that says nothing of what the rows show. Nor is an effect asked that does what it does about
standstill, one with memory or a friction of the speed: there sampling hides its form.
"""

from __future__ import annotations

from dataclasses import replace

from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests, tested_at
from fricmodels.diagnosis.effect_set import Member, Rest, member_of
from fricmodels.diagnosis.passive import of_speed
from fricmodels.diagnosis.support import support_of
from fricmodels.diagnosis.verdict import LookAlikes


def that_all_motion_allows(
    result: CandidateTests, effects: list[LookAlikes]
) -> tuple[list[LookAlikes], frozenset[str]]:
    """Return effects without those than which something else predicts clearly more over all motion, and these by name.

    A look-alike of such a one that stands there takes its place.

    Args:
        result: the tests on the rows that show the effects.
        effects: these, each with its look-alikes.
    """
    if all(_acts_about_standstill(result, found.first) for found in effects):
        return effects, frozenset()
    every = result.problem.including_uncertain_motion
    if every.rows == result.problem.rows:
        return effects, frozenset()
    there = candidate_tests(every, result.parameters, only=(), policy=result.policy)
    standing, refuted = [], set[str]()
    for found in effects:
        others = [_over_all_motion(there, other.first) for other in effects if other is not found]
        members = [t for t in found.members if t.name not in refuted]
        while members and _is_refuted(there, members[0], [m for m in others if m is not None]):
            refuted.add(members.pop(0).name)
        if members:
            standing.append(LookAlikes(members[0], tuple(members)))
    return standing, frozenset(refuted)


def _is_refuted(result: CandidateTests, tested: CandidateTest, others: list[Member]) -> bool:
    """Whether an effect explains most over all motion, beside others, and a channel clearly more."""
    member = None if _acts_about_standstill(result, tested) else _over_all_motion(result, tested)
    if member is None:
        return False
    found = support_of(result, member, others, Rest.of(result, [member, *others]))
    return found.own_share >= result.policy.own_share and found.is_outpredicted(result.policy)


def _acts_about_standstill(result: CandidateTests, tested: CandidateTest) -> bool:
    model = result.problem.alone(tested.effect).model
    return bool(model.states) or (tested.effect.friction and of_speed(model))


def _over_all_motion(result: CandidateTests, tested: CandidateTest) -> Member | None:
    """Return an effect that the rows show as it is over all motion; ``None`` where nothing of it is seen there."""
    problem, found = result.problem, tested.found
    columns, _ = problem.columns(problem.alone(tested.effect), found.nonlinear, found.delay)
    here = tested_at(result.regression, tested.effect, replace(found, columns=columns[found.kept]))
    return member_of(result, LookAlikes(here, (here,))) if len(here.evidence.coefficients) else None
