"""A plugin for another version of the interface is left out, and told which of the two to update."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from fricmodels.hookspecs import INTERFACE, hookimpl
from fricmodels.laws.coulomb_viscous import CoulombViscous
from fricmodels.plugins import loading


def module(written_for: Any) -> ModuleType:
    made = ModuleType("made")
    if written_for is not None:
        vars(made)["fricmodels_interface"] = written_for
    laws: Any = hookimpl(lambda: [type("Own", (CoulombViscous,), {"name": "own-law"})])
    vars(made)["fricmodels_laws"] = laws
    return made


@pytest.mark.parametrize(
    ("written_for", "problem"),
    [
        (None, ""),
        (INTERFACE, ""),
        (INTERFACE + 1, f"it is for plugin interface {INTERFACE + 1}, this is {INTERFACE}; update fricmodels"),
        (INTERFACE - 1, "update the plugin"),
        ("new", "it is for plugin interface 'new'"),
    ],
)
def test_versions(written_for: Any, problem: str) -> None:
    point: Any = SimpleNamespace(name="made", dist=SimpleNamespace(name="made"), load=lambda: module(written_for))
    offers, problems = loading.offered(point, loading._manager())
    assert [cls.name for _, cls in offers] == ([] if problem else ["own-law"])
    assert [problem in each.reason for each in problems] == ([True] if problem else [])
