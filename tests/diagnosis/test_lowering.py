"""A step of the ladder goes up to the rung with the lowest printed test error, and no further."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fricmodels.diagnosis import by_fit, compare, diagnose, improve
from fricmodels.diagnosis import search as searching
from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.diagnose import Diagnosis, Finding, comes_near
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.ladder import Rung
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.refits import Refits
from fricmodels.diagnosis.support import Support
from fricmodels.diagnosis.supported import Judgement
from fricmodels.diagnosis.verdict import LookAlikes, passing_all_gates
from fricmodels.recording import Recording

Made = Callable[..., Recording]


def fitted(error: float) -> Any:
    errors = SimpleNamespace(held_out_percent=error)
    return SimpleNamespace(errors=errors, sliding=errors)


@pytest.mark.parametrize(
    ("errors", "void", "kept", "left_out"),
    [
        ([5.0], "", "a", ""),
        ([12.0], "", "", "a"),
        ([10.0], "", "", "a"),
        ([12.0, 8.0], "", "ab", ""),  # two that help together
        ([5.0, 7.0], "", "a", "b"),
        ([5.0, 7.0, 6.0], "", "a", "b"),  # lower than the one before, and no better than the first alone
        ([5.0, 7.0, 4.0], "", "abc", ""),
        ([11.0, 12.0, 10.5], "", "", "a"),
        ([5.0], "a", "", "a"),  # nothing lowers no error
        ([8.0, 5.0], "b", "a", "b"),
        ([8.0, 5.0], "a", "ab", ""),  # the next one lowers it beside that; what is nothing is taken out afterwards
    ],
)
def test_up_to_the_lowest_error(
    errors: list[float], void: str, kept: str, left_out: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(searching, "from_scratch", lambda comparison: comparison)
    monkeypatch.setattr(searching, "is_void", lambda comparison, name: name == void)
    first: Any = SimpleNamespace(comparison=fitted(10.0), judgement=None)
    search = searching.Search(set(), set(), POLICY, first)
    step: Any = [(first, Rung(fitted(error), added=name)) for name, error in zip("abc", errors, strict=False)]
    assert "".join(rung.added for _, rung in search._lowering(step)) == kept
    assert "".join(search._superfluous) == left_out
    assert ("it is nothing" if left_out == void else "does not fall") in search.note if left_out else not search.note


@pytest.mark.parametrize(("imitating", "tried"), [("", "ab"), ("a", "bc"), ("b", "ac"), ("bc", "a")])
def test_a_pair_is_not_of_what_imitates_one_cause(imitating: str, tried: str, monkeypatch: pytest.MonkeyPatch) -> None:
    tested = {name: cast(CandidateTest, SimpleNamespace(name=name)) for name in "abc"}
    classes = {name: LookAlikes(one, (one,)) for name, one in tested.items()}
    support = Support(own_share=0.4, of_channel=1.0, torque=0.1, p_value=1e-9)
    members = tuple((found, support) for found in classes.values())
    judgement = Judgement(members, tuple(classes[name] for name in imitating), (), 0.0, 0.0)
    first: Any = SimpleNamespace(comparison=fitted(10.0), judgement=judgement)
    search, chained = searching.Search(set(), set(), POLICY, first), list[str]()

    def chain(findings: list[Finding]) -> list[Any]:
        chained.extend(finding.tested.name for finding in findings)
        return []

    monkeypatch.setattr(search, "_chain", chain)
    assert search._pair() == []
    assert "".join(chained) == tried


@pytest.mark.parametrize(
    ("errors", "alone", "jointly"),
    [([5.0, 7.0], "a", ""), ([5.0, 4.0, 7.0], "ab", ""), ([5.0, 4.0, 3.0], "abc", "abc")],
)
@pytest.mark.parametrize("only_jointly", [False, True])
def test_of_effects_that_show_only_jointly_all_are_added_or_none(
    errors: list[float], alone: str, jointly: str, only_jointly: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(searching, "from_scratch", lambda comparison: comparison)
    monkeypatch.setattr(searching, "is_void", lambda comparison, name: False)
    first: Any = SimpleNamespace(comparison=fitted(10.0), judgement=SimpleNamespace(only_jointly=only_jointly))
    search = searching.Search(set(), set(), POLICY, first)
    step: Any = [(first, Rung(fitted(error), added=name)) for name, error in zip("abc", errors, strict=False)]
    assert "".join(rung.added for _, rung in search._lowering(step)) == (jointly if only_jointly else alone)


def test_look_alikes_are_those_beside_the_others_though_one_of_them_comes_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It may not take the place, by a hair: what only stood for both causes is taken back all the same.

    So is what leaves far more, fitted in its place.
    """
    name, first = "torque-gain", SimpleNamespace(name="inertia-error")
    found = Finding(cast(CandidateTest, SimpleNamespace(name=name)), (name, "inertia-error", "stiffness"), "")
    search = searching.Search(set(), set(), POLICY, cast(Any, SimpleNamespace(comparison=fitted(10.0), refused=None)))
    search.steps = [Diagnosis(cast(Any, None), "missing-effect", (found,), None, {})]
    members = (first, SimpleNamespace(name=name), SimpleNamespace(name="drift"))
    seen = iter([SimpleNamespace(first=first, names=("inertia-error", name, "drift"), members=members), None])
    monkeypatch.setattr(searching.Search, "_added", property(lambda self: [name, "torque-offset"]))
    monkeypatch.setattr(searching.Search, "_place", lambda self, name: 0)
    monkeypatch.setattr(searching.Search, "_without", lambda self, comparison, name: comparison)
    monkeypatch.setattr(searching.Search, "_may_replace", lambda self, other, smaller: False)
    monkeypatch.setattr(searching, "seems_missing", lambda *arguments: next(seen))
    refits = SimpleNamespace(with_effect=lambda tested: tested, leaves_as_much=lambda tested, _: tested.name != "drift")
    monkeypatch.setattr(searching, "Refits", lambda *arguments: refits)
    assert not search.exchange()
    assert search.steps[0].findings[0].names == (name, "inertia-error")


@pytest.mark.long
def test_what_the_ladder_gives_up_is_not_missing(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    recording = made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5}, samples=4000)
    monkeypatch.setattr(searching.Search, "_lowering", lambda self, step: self._superfluous.add("gravity") or [])
    found = improve(recording, "coulomb-viscous", 2.0)
    assert len(found.rungs) == 1
    answer = document(found.first, found)
    assert answer.effects == ()
    assert answer.verdict == "unknown-effect"
    assert "'gravity' explains part of it, but the test error does not fall with it" in answer.explanation


@pytest.mark.long
@pytest.mark.parametrize(("droop", "expected"), [(0.0, "inertia-error"), (0.005, "")])
def test_what_has_another_form_is_not_taken_for_its_test_error(
    made: Made, monkeypatch: pytest.MonkeyPatch, droop: float, expected: str
) -> None:
    """The test error does not fall with what was found, but with a wrong inertia; a torque that droops is none."""
    recording = made(samples=4000)
    torque = recording.torque + (droop * np.abs(recording.torque) if droop else 0.25) * recording.torque
    first = diagnose(recording.with_channels(derived=False, torque=torque), "coulomb-viscous", 2.0)
    assert first.refits is not None
    assert first.result is not None
    assert "inertia-error" in {t.name for t in passing_all_gates(first.result)}
    other = next(t for t in first.result.tested if t.name == "joint-compliance")
    monkeypatch.setattr(Refits, "lowers_test_error", lambda self, tested: tested.name == "inertia-error")
    taken = by_fit.confirmed(first.refits, LookAlikes(other, (other,)), first.result, set(), [])
    assert (taken.first.name if taken else "") == expected


def test_only_what_comes_near_in_the_rows_is_fitted_in_the_place_of_an_effect(made: Made) -> None:
    smaller = compare(made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5}), "coulomb-viscous", 2.0)
    near = comes_near(smaller, "gravity", ())
    assert "gravity" in near
    assert near.isdisjoint({"torque-offset", "stiffness", "stribeck", "drift"})
    assert comes_near(smaller, "no such effect", ()) > near
    assert comes_near(smaller, "gravity", (), POLICY.without("far_worse")) == comes_near(smaller, "torque-offset", ())


@pytest.mark.parametrize(("kept", "verdict"), [(("a",), "missing-effect"), (("a", "b"), "undecided")])
@pytest.mark.parametrize("before", [("a",), ("a", "b")])
def test_the_verdict_is_that_of_the_look_alikes_that_were_kept(
    before: tuple[str, ...], kept: tuple[str, ...], verdict: str
) -> None:
    """Beside the others an effect has other look-alikes than it had when nothing was known."""

    def diagnosis(names: tuple[str, ...]) -> Diagnosis:
        found = Finding(cast(Any, SimpleNamespace(name="a")), names, "")
        return Diagnosis(
            cast(Any, fitted(10.0)), "missing-effect" if len(names) == 1 else "undecided", (found,), None, {}
        )

    first = diagnosis(before)
    search = searching.Search(set(), set(), POLICY, first)
    after: Any = SimpleNamespace(drive=SimpleNamespace(model=SimpleNamespace(effects=[SimpleNamespace(name="a")])))
    search.rungs.append(Rung(after, added="a"))
    search.steps.append(diagnosis(kept))
    assert search.ladder().first.verdict == verdict
