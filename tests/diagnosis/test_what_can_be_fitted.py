"""What cannot be fitted gives way to what explains the rows nearly as well; what only accompanies is no effect."""

from __future__ import annotations

import importlib
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.diagnosis.refits import is_nothing, is_undetermined
from fricmodels.diagnosis.verdict import LookAlikes

CONTACT = {"presliding.F_1": 2.0, "presliding.F_2": 2.0, "presliding.D": 1.0, "presliding.x_s": 0.2}


@dataclass(frozen=True)
class Result:
    """Candidates, best first, that are no look-alikes of each other."""

    tested: tuple[Any, ...]
    policy: Policy = POLICY


@pytest.mark.parametrize(
    ("losses", "refused", "left"),
    [
        ([1.0, 1.2, 4.0], "", "abc"),
        ([1.0, 1.2, 4.0], "a", "bc"),
        ([1.0, 2.2, 4.0], "ab", "abc"),  # c leaves 1.5 times the RMS of a and more: it has another form
        ([1.0, 1.2, 1.4], "ab", "c"),
        ([1.0, 1.2, 1.4], "abc", "abc"),
    ],
)
def test_the_next_one_is_asked_if_it_explains_nearly_as_much(
    losses: list[float], refused: str, left: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    diagnose = importlib.import_module("fricmodels.diagnosis.diagnose")
    tested = tuple(
        SimpleNamespace(name=name, evidence=SimpleNamespace(loss=[loss]))
        for name, loss in zip("abc", losses, strict=True)
    )

    def first_of(result: Result) -> Any:
        return LookAlikes(result.tested[0], result.tested[:1]) if result.tested else None

    monkeypatch.setattr(diagnose, "select_effect", first_of)
    refits = SimpleNamespace(with_effect=lambda t: None if t.name in refused else t)
    assert "".join(t.name for t in diagnose._that_can_be_fitted(refits, Result(tested)).tested) == left


def test_damping_alone_is_no_contact_that_bends(made: Made) -> None:
    fitted = compare(made("coulomb-viscous+presliding", CONTACT, samples=4000), "coulomb-viscous+presliding", INERTIA)
    assert not is_nothing(fitted, "presliding")
    assert not is_undetermined(fitted, "presliding")

    def with_values(**values: float) -> Any:
        own = {f"presliding.{symbol}": value for symbol, value in values.items()}
        estimate = replace(fitted.estimate, parameters={**fitted.estimate.parameters, **own})
        return replace(fitted, estimate=estimate)

    assert is_undetermined(with_values(F_1=0.0, F_2=0.0), "presliding")
    assert not is_undetermined(with_values(F_1=0.0), "presliding")
