"""The decision constants: each is documented, each rule acts, and each can be switched off."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import FrozenInstanceError, fields, replace
from pathlib import Path

import pytest

from fricmodels import diagnosis
from fricmodels.diagnosis import compare, diagnose, examine
from fricmodels.diagnosis.explain import explain
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.recording import Recording

Made = Callable[..., Recording]
NUMBERS = ("refit_trials", "step_trials", "most_steps", "most_together")
RULES = [entry.name for entry in fields(Policy)]
LAW = "coulomb-viscous"


@pytest.mark.parametrize("row", Policy.table(), ids=RULES)
def test_every_constant_has_a_unit_a_rule_and_its_evidence(row: tuple[str, ...]) -> None:
    name, value, unit, rule, evidence = row
    assert name in RULES
    assert value
    assert unit
    assert rule.endswith(".")
    assert re.match(r"(Statistic|Physical|Found on|Judgement)", evidence)
    assert evidence.endswith(".")


@pytest.mark.parametrize("rule", RULES)
def test_every_constant_is_used_by_a_rule(rule: str) -> None:
    """By a module of the diagnosis other than the policy itself."""
    folder = Path(diagnosis.__file__).parent
    text = "".join(path.read_text(encoding="utf-8") for path in folder.glob("*.py") if path.name != "policy.py")
    assert re.search(rf"policy\.{rule}\b", text)


def test_the_policy_is_frozen_and_a_rule_is_switched_off_by_name() -> None:
    with pytest.raises(FrozenInstanceError):
        POLICY.significance = 0.5  # type: ignore[misc]
    other = POLICY.without("of_channel")
    assert other == replace(POLICY, of_channel=0.0)
    with pytest.raises(ValueError, match=r"no rule 'most_steps' .* known: significance"):
        POLICY.without("most_steps")


def test_the_policy_decides_and_the_diagnosis_says_which(made: Made) -> None:
    """What is said of a drive with nothing hidden holds the constant that decided."""
    comparison = compare(made(noise=1.0), LAW, 2.0)
    assert examine(comparison).verdict == "adequate"
    assert "comes to 0.3 % of the torque" in explain(examine(comparison))
    lax = replace(POLICY, least_torque=0.001)
    found = examine(comparison, policy=lax)
    assert found.policy is lax
    assert "comes to 0.1 % of the torque" in explain(found)


@pytest.mark.long
def test_without_the_rules_of_support_a_wrong_name_is_given(made: Made) -> None:
    """With the true effect off the list another one explains most of it, and a channel predicts far more."""
    recording = made("coulomb-viscous+asymmetry", {"asymmetry.c": 0.3, "asymmetry.d": -0.2})
    found = diagnose(recording, LAW, 2.0, leave_out=["asymmetry"])
    assert (found.verdict, found.findings) == ("unknown-effect", ())
    lax = POLICY.without("own_share").without("of_channel")
    wrong = diagnose(recording, LAW, 2.0, leave_out=["asymmetry"], policy=lax)
    assert wrong.findings[0].names == ("torque-offset",)


SWITCHED = [name for name in RULES if name not in NUMBERS]


@pytest.mark.parametrize(
    "rule", [pytest.param(name, marks=pytest.mark.long if i % 4 else ()) for i, name in enumerate(SWITCHED)]
)
def test_a_diagnosis_ends_whichever_rule_is_off(rested: Callable[[], diagnosis.Comparison], rule: str) -> None:
    """On a strong effect alone no single rule decides: the name stands without any of them."""
    found = examine(rested(), policy=POLICY.without(rule))
    assert found.findings[0].names[0] == "gravity"


@pytest.fixture(scope="module")
def rested(made: Made) -> Callable[[], diagnosis.Comparison]:
    comparison = compare(made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5}, samples=4000), LAW, 2.0)
    return lambda: comparison
