"""An effect with more parameters that adds nothing to a simpler one does not come before it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from fricmodels.diagnosis import refit_check
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.verdict import LookAlikes


def candidate(name: str) -> Any:
    return SimpleNamespace(name=name, effect=SimpleNamespace(name=name, parameters=()))


@pytest.mark.parametrize(
    ("simple", "inside", "first_helps", "led_by"),
    [
        (10.2, True, True, "simple"),  # higher by no more than the margin of an exchange
        (9.0, True, True, "simple"),
        (10.3, True, True, "larger"),
        (9.0, False, True, "larger"),  # it is something else, not a part of the larger one
        (9.0, True, False, "larger"),  # the larger one is not what is missing, and says nothing of a part of it
        (float("inf"), True, True, "larger"),
    ],
)
def test_a_simpler_one_within_it_leads(
    simple: float, inside: bool, first_helps: bool, led_by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As friction of the load, where two coefficients by the direction of power are equal within their errors."""
    larger, simpler, errors = candidate("larger"), candidate("simple"), {"larger": 10.0, "simple": simple}
    refits: Any = SimpleNamespace(
        test_error=lambda t: errors[t.name], lowers_test_error=lambda t: first_helps or t is simpler
    )
    monkeypatch.setattr(refit_check, "passing_all_gates", lambda _: [simpler])
    monkeypatch.setattr(refit_check, "contains", lambda *_: inside)
    result: Any = SimpleNamespace(policy=POLICY)
    named = refit_check._with_a_simpler_one(refits, result, LookAlikes(larger, (larger,)))
    assert named.first.name == led_by
    assert set(named.names) == ({"larger", "simple"} if led_by == "simple" else {"larger"})


def test_a_look_alike_within_the_first_leads_and_the_others_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    """As an offset before a spring over a short travel."""
    larger, simpler, other = candidate("larger"), candidate("simple"), candidate("other")
    refits: Any = SimpleNamespace(test_error=lambda t: 10.1 if t is simpler else 10.0, lowers_test_error=lambda _: True)
    monkeypatch.setattr(refit_check, "passing_all_gates", lambda _: [larger, simpler, other])
    monkeypatch.setattr(refit_check, "contains", lambda _, big, small: big is larger and small is simpler)
    result: Any = SimpleNamespace(policy=POLICY)
    named = refit_check._with_a_simpler_one(refits, result, LookAlikes(larger, (larger, other, simpler)))
    assert named.names == ["simple", "larger", "other"]
