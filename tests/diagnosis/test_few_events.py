"""An effect that few events hold: rows see it, too, and cannot say how certain its gain is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from fricmodels.diagnosis import refit_check
from fricmodels.diagnosis.policy import POLICY


def candidate(name: str, adjusted: float, gain: float) -> Any:
    effect = SimpleNamespace(states=("z",) if name in ("backlash", "presliding") else ())
    return SimpleNamespace(
        name=name, effect=effect, adjusted=adjusted, evidence=SimpleNamespace(gain=gain, gain_p_value=0.1)
    )


def those(*candidates: Any) -> Any:
    return SimpleNamespace(tested=candidates, policy=POLICY)


@pytest.mark.parametrize(
    ("share", "adjusted", "gain", "asked"),
    [
        (0.4, 1.0, 0.0, True),  # most of it lies where rows are silent
        (0.6, 1.0, 0.3, False),  # rows see most of it, and say nothing
        (0.6, 1e-9, -0.1, False),  # and that it predicts nothing
        (0.6, 1e-9, 0.3, True),  # and that it is there; few events do not tell by how much the error falls
    ],
)
def test_what_the_rows_say_too_is_asked_on_all_motion(
    monkeypatch: pytest.MonkeyPatch, share: float, adjusted: float, gain: float, asked: bool
) -> None:
    """Friction that falls near standstill in thirty moves: p < 1e-20 in rows, 33 % of the error, at p = 0.10."""
    found: list[list[str]] = []
    everywhere = those(candidate("stribeck", 1e-20, 0.4), candidate("gravity", 1.0, 0.5))
    monkeypatch.setattr(refit_check, "candidate_tests", lambda *_, **__: everywhere)
    monkeypatch.setattr(refit_check, "replace", lambda problem: problem)
    monkeypatch.setattr(refit_check, "_error", lambda _: 5.0)
    monkeypatch.setattr(refit_check, "_share_in_rows", lambda *_: share)
    monkeypatch.setattr(refit_check, "_best", lambda *args: found.append([t.name for t in args[2]]))
    comparison: Any = SimpleNamespace(
        problem=SimpleNamespace(including_uncertain_motion=None), estimate=SimpleNamespace(parameters={})
    )
    refits: Any = SimpleNamespace(comparison=comparison)
    in_rows = those(candidate("presliding", 1.0, 0.2), candidate("stribeck", adjusted, gain))
    assert refit_check._on_all_motion(refits, in_rows, set(), 5.0) is None
    assert found == [["stribeck"] if asked else []]


def test_only_the_best_of_those_that_rows_see_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each costs a fit, and all but one of them resemble that one."""
    found: list[list[str]] = []
    both = those(candidate("stribeck", 1e-20, 0.4), candidate("backlash", 1e-20, 0.3))
    monkeypatch.setattr(refit_check, "candidate_tests", lambda *_, **__: both)
    monkeypatch.setattr(refit_check, "replace", lambda problem: problem)
    monkeypatch.setattr(refit_check, "_error", lambda _: 5.0)
    monkeypatch.setattr(refit_check, "_share_in_rows", lambda *_: 0.6)
    monkeypatch.setattr(refit_check, "_best", lambda *args: found.append([t.name for t in args[2]]))
    problem = SimpleNamespace(including_uncertain_motion=None)
    comparison: Any = SimpleNamespace(problem=problem, estimate=SimpleNamespace(parameters={}))
    refits: Any = SimpleNamespace(comparison=comparison)
    assert refit_check._on_all_motion(refits, both, set(), 5.0) is None
    assert found == [["stribeck"]]
    assert refit_check._on_all_motion(refits, those(candidate("backlash", 1e-20, 0.3)), set(), 5.0) is None
    assert found[1] == []  # one with memory
