"""A set of effects without those that the others have made superfluous, and without what has a place of its own."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import compare, examine, improve, ladder
from fricmodels.diagnosis import search as searching
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.effect_set import Member, columns_and_tangents, pruned
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.search import Search
from fricmodels.diagnosis.support import Support
from fricmodels.diagnosis.supported import Judgement
from fricmodels.diagnosis.verdict import LookAlikes


def found(made: Made, name: str, values: dict[str, float], only: set[str]) -> tuple[CandidateTests, list[Member]]:
    """Return the tests of some effects on a drive, and a set of all of them, by their names."""
    comparison = compare(made(name, values), "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=only)
    tested = sorted(result.tested, key=lambda t: t.name)
    return result, [Member(LookAlikes(t, (t,)), columns_and_tangents(result, t)) for t in tested]


@pytest.mark.parametrize("backward", [False, True])
def test_an_effect_that_adds_nothing_beside_another_leaves_the_set(made: Made, backward: bool) -> None:
    """Whichever was found first: a part of gravity looks like a stiffness, and nothing of it is left beside gravity."""
    result, members = found(
        made, "coulomb-viscous+gravity", {"gravity.a": 0.3, "gravity.b": 0.1}, {"gravity", "stiffness"}
    )
    assert len(members) == 2
    kept = pruned(result, members[::-1] if backward else members)
    assert [m.found.names for m in kept] == [["gravity"]]


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("other", ["asymmetry", "torque-offset"])
def test_what_is_at_its_search_bound_makes_no_other_superfluous(made: Made, other: str, backward: bool) -> None:
    """Of two that are one column that stays which may be the cause; one at a bound only describes it."""
    result, members = found(
        made, "coulomb-viscous+torque-offset", {"torque-offset.tau_0": 0.1}, {"asymmetry", "torque-offset"}
    )

    def at_bound(member: Member) -> Member:
        first = member.found.first
        first = replace(first, found=replace(first.found, at_search_bound=True))
        return replace(member, found=LookAlikes(first, (first,)))

    members = [m if m.effect.name == other else at_bound(m) for m in members]
    kept = pruned(result, members[::-1] if backward else members)
    assert [m.effect.name for m in kept if not m.at_bound] == [other]


def test_an_effect_that_does_the_same_becomes_a_look_alike(made: Made) -> None:
    """Without rests an offset and a Coulomb asymmetry are one column: one stays, and knows of the other."""
    result, members = found(
        made, "coulomb-viscous+torque-offset", {"torque-offset.tau_0": 0.1}, {"asymmetry", "torque-offset"}
    )
    assert len(members) == 2
    kept = pruned(result, members)
    assert len(kept) == 1
    assert set(kept[0].found.names) == {"asymmetry", "torque-offset"}


@pytest.mark.long
def test_an_effect_that_came_to_nothing_leaves_the_ladder(made: Made) -> None:
    """Friction that bends down over speed is lowest near zero: the Stribeck effect is at its bound."""
    values = {"gravity.a": 0.3, "gravity.b": 0.1, "nonlinear-viscous.b": -0.02}
    recording = made("coulomb-viscous+gravity+nonlinear-viscous", values)
    comparison = compare(recording, "coulomb-viscous+gravity+stribeck", INERTIA)
    assert comparison.estimate.parameters["stribeck.F_s"] == 0.0
    search = Search(set(), set(), POLICY, examine(comparison))
    assert search.prune()
    assert search.rungs[-1].model == "coulomb-viscous+gravity"
    assert search.rungs[-1].removed == "stribeck"


def test_an_effect_without_which_the_test_error_is_no_higher_leaves_the_ladder(
    made: Made, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the rows say of it: every effect of the ladder lowers the printed test error."""
    recording = made("coulomb-viscous+gravity", {"gravity.a": 0.3, "gravity.b": 0.1}, noise=0.5)
    comparison = compare(recording, "coulomb-viscous+gravity+asymmetry", INERTIA)
    alone = compare(recording, "coulomb-viscous+gravity", INERTIA)
    assert alone.errors.held_out_percent <= comparison.errors.held_out_percent
    sure = SimpleNamespace(gain=0.5, p_value=1e-9)
    monkeypatch.setattr(searching, "necessity", lambda comparison, name: sure)
    monkeypatch.setattr(searching, "is_void", lambda comparison, name: False)
    search = Search(set(), set(), POLICY, examine(comparison))
    assert search.prune()
    assert search.rungs[-1].model == "coulomb-viscous+gravity"
    assert search._added == ["gravity"]


def test_what_is_there_by_itself_is_no_look_alike_of_another() -> None:
    """A contact with a long way bends like a spring: it may stand for gravity, but not where it is there beside it."""

    def tested(name: str) -> Any:
        return SimpleNamespace(name=name, once=1e-9)

    gravity, stiffness, presliding = map(tested, ("gravity", "stiffness", "presliding"))
    enough = Support(own_share=0.9, of_channel=float("inf"), torque=0.1, p_value=1e-9)
    both = (
        (LookAlikes(gravity, (gravity, stiffness, presliding)), enough),
        (LookAlikes(presliding, (presliding,)), enough),
    )
    judgement = Judgement(both, (), (), 0.0, 0.0)
    assert [one.names for one in judgement.supported(POLICY)] == [["gravity", "stiffness"], ["presliding"]]
    gravity.once = 0.5
    assert [one.names for one in judgement.supported(POLICY)] == [["presliding"]], "it repeats, and shows but once"
    gravity.once = 1e-9
    small = both[0], (both[1][0], replace(enough, torque=0.0))
    assert replace(judgement, members=small).supported(POLICY)[0].names == ["gravity", "stiffness", "presliding"]
    about_rest = both[0], (both[1][0], replace(enough, torque=0.0, over_all_motion=True))
    found = replace(judgement, members=about_rest).supported(POLICY)
    assert [one.names for one in found] == [["gravity", "stiffness"], ["presliding"]], "small in the rows alone"


@pytest.mark.long
def test_what_was_removed_and_found_again_is_listed_once(made: Made) -> None:
    """Where it was found again."""
    recording = made("coulomb-viscous+gravity+asymmetry", {"gravity.a": 0.5, "asymmetry.c": 0.2})
    known = improve(recording, "coulomb-viscous", INERTIA)
    small, first, second = known.rungs
    detour = (small, second, replace(small, added="", removed=second.added), first, second)
    again = replace(known, rungs=detour, steps=(known.steps[1], *known.steps))
    assert [finding.tested.name for finding in ladder.added(again)] == [first.added, second.added]


def test_what_the_last_step_makes_superfluous_leaves_the_ladder(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    recording = made("coulomb-viscous+gravity", {"gravity.a": 0.3, "gravity.b": 0.1}, noise=0.5)
    diagnosis = examine(compare(recording, "coulomb-viscous", INERTIA))
    alike = compare(recording, "coulomb-viscous+asymmetry", INERTIA)
    both = compare(recording, "coulomb-viscous+asymmetry+gravity", INERTIA)
    search = Search(set(), set(), POLICY, diagnosis)
    rungs = iter([[ladder.Rung(alike, added="asymmetry")], [ladder.Rung(both, added="gravity")]])
    monkeypatch.setattr(Search, "extend", lambda self: self.rungs.extend(next(rungs)))
    monkeypatch.setattr(Search, "exchange", lambda self: len(self.rungs) == 2)
    monkeypatch.setattr(Search, "simplify", lambda self: False)
    monkeypatch.setattr(Search, "diagnose", lambda self: None)
    search.to_the_end()
    assert search.rungs[-1].model == "coulomb-viscous+gravity"
    assert search.rungs[-1].removed == "asymmetry"
