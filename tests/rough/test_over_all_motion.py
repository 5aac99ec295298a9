"""What the rows show is judged over all motion, too: they leave out where two torques that are alike in them part."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from types import ModuleType

import pytest

from fricmodels.diagnosis import Diagnosis, diagnose


def _diagnosed(from_benchmarks: Callable[[str], ModuleType], kind: str, name: str, index: int, seed: int) -> Diagnosis:
    case, *_ = from_benchmarks("rough.trials").case_of(kind, name, index, seed)
    return diagnose(from_benchmarks("rough.record").record(case), "coulomb-viscous", case.inertia)


@pytest.mark.parametrize(("index", "seed"), [(3, 7701), (4, 7701)])
def test_a_torque_that_falls_short_of_the_current_is_no_gain(
    from_benchmarks: Callable[[str], ModuleType], index: int, seed: int
) -> None:
    """A gain explains 99 and 78 % of the rows, and no channel more; 94 and 85 % over all motion, where one does."""
    found = _diagnosed(from_benchmarks, "unlisted", "droop", index, seed)
    assert found.verdict == "unknown-effect"
    assert found.refuted == {"torque-gain", "inertia-error"}
    assert found.remaining is not None
    assert [one.against for one in found.remaining.nearest if one.name == "torque-gain"] == [
        "over all motion, reversals included, a channel predicts clearly more"
    ]


def test_what_is_refuted_was_seen_all_the_same(
    from_benchmarks: Callable[[str], ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no channel predicts anything in the rows, the effect does, whatever its form."""
    module = importlib.import_module("fricmodels.diagnosis.diagnose")
    monkeypatch.setattr(module, "passing_predictors", lambda *_: [])
    found = _diagnosed(from_benchmarks, "unlisted", "droop", 3, 7701)
    assert not found.findings
    assert found.view is not None
    assert "torque-gain" in found.view.channels


def test_what_acts_about_the_reversals_says_nothing_of_what_the_rows_show(
    from_benchmarks: Callable[[str], ModuleType],
) -> None:
    """A contact bends at every reversal, beside a wrong gain: the distance since the last one predicts most there."""
    found = _diagnosed(from_benchmarks, "several", "", 20, 7601)
    assert "torque-gain" in found.findings[0].names
    assert not found.refuted


def test_a_look_alike_that_stands_over_all_motion_takes_the_place_of_one_that_does_not(
    from_benchmarks: Callable[[str], ModuleType],
) -> None:
    """On one sine rows cannot tell a friction that differs between the directions from an offset."""
    found = _diagnosed(from_benchmarks, "single", "asymmetry", 1, 7601)
    assert found.refuted == {"torque-offset"}
    assert [one.names[0] for one in found.findings] == ["asymmetry"]
