"""Effects that are there must be so without those that are not."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from fricmodels.diagnosis import examine, supported
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.support import Support
from fricmodels.diagnosis.supported import Judgement
from fricmodels.diagnosis.verdict import LookAlikes

STANDS, FALLS = Support(0.9, float("inf"), 0.1, 1e-9), Support(0.9, 0.9, 0.1, 1e-9)


def effect(name: str) -> LookAlikes:
    tested: Any = SimpleNamespace(name=name, once=0.0, effect=SimpleNamespace(depends_on_time=False))
    return LookAlikes(tested, (tested,))


EFFECTS = {name: effect(name) for name in "abc"}
WHOLE = frozenset("abc")


@pytest.mark.parametrize(
    ("standing", "there"),
    [
        ({WHOLE: "abc"}, "abc"),
        ({WHOLE: "ab", frozenset("ab"): "ab"}, "ab"),
        ({WHOLE: "ab", frozenset("ab"): "a", frozenset("a"): "a"}, "a"),
        ({WHOLE: "ab", frozenset("ab"): "a", frozenset("a"): ""}, ""),
        ({WHOLE: ""}, ""),
    ],
)
def test_what_stands_is_judged_again_until_all_of_it_stands(
    monkeypatch: pytest.MonkeyPatch, standing: dict[frozenset[str], str], there: str
) -> None:
    """By each set the names of those that stand in it; asked is only for sets in which one fell."""
    asked = []

    def at_once(_: Any, members: list[Any], rest: str) -> Judgement:
        names = frozenset(m.found.first.name for m in members)
        asked.append((names, rest))
        judged = tuple((m.found, STANDS if m.found.first.name in standing[names] else FALLS) for m in members)
        return Judgement(judged, (), (), 0.0, 0.0)

    monkeypatch.setattr(supported, "_judged_at_once", at_once)
    monkeypatch.setattr(supported.Rest, "of", lambda _, members: "".join(m.found.first.name for m in members))
    result: Any = SimpleNamespace(policy=POLICY)
    members: list[Any] = [SimpleNamespace(found=EFFECTS[name], at_bound=False) for name in "abc"]
    rest: Any = "abc"
    judgement = supported._judged(result, members, rest)
    assert "".join(found.first.name for found in judgement.supported(POLICY)) == there
    assert [found.first.name for found, _ in judgement.members] == list("abc")
    assert asked == [(names, "".join(sorted(names))) for names in standing]


@pytest.mark.long
def test_no_memory_is_named_for_an_inertia_that_is_off_the_list(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a presliding and a wave that are not there it does as much of what they leave as the acceleration does."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks"))
    draw = importlib.import_module("hidden.draw")
    drawn = draw.mattering(draw.generator(61, "single", "inertia-error", 0), "inertia-error")
    diagnosis = examine(drawn.comparison, leave_out={"inertia-error"})
    assert diagnosis.verdict == "unknown-effect"
    assert diagnosis.view is not None
    assert diagnosis.view.channels == "acceleration and speed"
