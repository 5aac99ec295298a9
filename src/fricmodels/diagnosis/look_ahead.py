"""Effects that show only once more is there: each of several others, or a description of another cause.

Where several causes are missing none need be significant by itself: each is tested against a residual that holds all
the others, too. So one that explains most, however uncertain, is taken to be there, others are sought beside it, and
then it is sought anew beside them. What is found so passes the same gates as any effect; where nothing is missing two
effects would have to pass them by chance, each beside the other.
"""

from __future__ import annotations

import numpy as np

from fricmodels.diagnosis.candidate_tests import CandidateTest, CandidateTests, candidate_tests
from fricmodels.diagnosis.effect_set import (
    Member,
    Rest,
    found_in_turn,
    member_of,
    nothing,
    pruned,
    regression_beside,
    renumbered,
    stacked,
)
from fricmodels.diagnosis.verdict import LookAlikes, select_effect

_SEEDS = 3
"""Effects that are taken to be there, one after the other."""


def set_ahead(result: CandidateTests, out: set[str]) -> list[Member]:
    """Return the set of two or more effects that explains most, each significant beside the others; or nothing.

    Args:
        result: the tests of all candidates, of which none stands by itself.
        out: effects that are not considered.
    """
    seeds = [t for t in result.tested if _explains(t, result) and not t.found.at_search_bound]
    sets = [_around(result, seed, out) for seed in seeds[:_SEEDS]]
    return min((found for found in sets if len(found) > 1), key=lambda found: _left(result, found), default=[])


def set_beside(result: CandidateTests, out: set[str], rest: Rest) -> list[Member]:
    """Return the set of effects beside a description of another cause; none where there is no description.

    An effect of another form than that cause stood for it, and those found after it for what it left.

    Args:
        result: the tests of all candidates.
        out: effects that are not considered, such as those that stood for the other cause.
        rest: the description.
    """
    if not rest.parts:
        return []
    members = found_in_turn(result, out, [], np.vstack(rest.parts))
    return renumbered(result, pruned(result, members))


def _explains(test: CandidateTest, result: CandidateTests) -> bool:
    return test.evidence.gain > result.policy.least_gain


def _around(result: CandidateTests, seed: CandidateTest, out: set[str]) -> list[Member]:
    """Return the effects that show beside a seed, and what shows in its place beside them."""
    begun = member_of(result, LookAlikes(seed, (seed,)))
    others = found_in_turn(result, out, [begun], nothing(result))[1:]
    if not others:
        return []
    again = candidate_tests(
        result.problem,
        result.parameters,
        leave_out=out,
        also=stacked(result, others),
        found=[m.effect.name for m in others],
        several=(),
        policy=result.policy,
    )
    best = select_effect(again)
    return [] if best is None else renumbered(result, pruned(result, [member_of(again, best), *others]))


def _left(result: CandidateTests, members: list[Member]) -> float:
    return float(np.sum(regression_beside(result, stacked(result, members), members).loss))
