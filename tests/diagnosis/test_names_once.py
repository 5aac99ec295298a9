"""What was added is no look-alike of what was added beside it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

from fricmodels.diagnosis.diagnose import Diagnosis, Finding
from fricmodels.diagnosis.search import _beside


def step(*names: str) -> Diagnosis:
    """Return a diagnosis that found the first of a class."""
    tested = cast(Any, SimpleNamespace(name=names[0]))
    return Diagnosis(cast(Any, None), "missing-effect", (Finding(tested, names, "more of it"),), None, {})


def test_a_class_loses_what_was_added_later() -> None:
    found = _beside(step("stribeck", "nonlinear-viscous"), {"stribeck", "nonlinear-viscous"}).findings[0]
    assert found.names == ("stribeck",)
    assert found.separated_by == ""
    three = _beside(step("drift", "thermal", "asymmetry"), {"drift", "asymmetry"}).findings[0]
    assert three.names == ("drift", "thermal")
    assert three.separated_by


def test_a_class_of_which_nothing_else_was_added_stays() -> None:
    before = step("stribeck", "nonlinear-viscous")
    assert _beside(before, {"stribeck", "gravity"}) is before
