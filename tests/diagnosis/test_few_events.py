"""An effect that few events hold: rows see it, too, and cannot say how certain its gain is."""

from __future__ import annotations

from collections.abc import Callable
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


Asked = Callable[..., list[str]]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Asked:
    """``asked(in_rows, everywhere, share)`` returns which candidates are fitted after all motion was looked at."""

    def ask(in_rows: Any, everywhere: Any, share: float, imitating: tuple[str, ...] = ()) -> list[str]:
        found: list[str] = []
        monkeypatch.setattr(refit_check, "candidate_tests", lambda *_, **__: everywhere)
        monkeypatch.setattr(refit_check, "replace", lambda problem: problem)
        monkeypatch.setattr(refit_check, "_error", lambda _: 5.0)
        monkeypatch.setattr(refit_check, "_share_in_rows", lambda *_: share)
        monkeypatch.setattr(refit_check, "_best", lambda *args: found.extend(t.name for t in args[2]))
        problem = SimpleNamespace(including_uncertain_motion=None)
        comparison = SimpleNamespace(problem=problem, estimate=SimpleNamespace(parameters={}))
        refits: Any = SimpleNamespace(comparison=comparison)
        assert refit_check._on_all_motion(refits, in_rows, set(), 5.0, imitating) is None
        return found

    return ask


@pytest.mark.parametrize(
    ("share", "adjusted", "gain", "is_asked"),
    [
        (0.4, 1.0, 0.0, True),  # most of it lies where rows are silent
        (0.6, 1.0, 0.3, False),  # rows see most of it, and say nothing
        (0.6, 1e-9, -0.1, False),  # and that it predicts nothing
        (0.6, 1e-9, 0.3, True),  # and that it is there; few events do not tell by how much the error falls
    ],
)
def test_what_the_rows_say_too_is_asked_on_all_motion(
    asked: Asked, share: float, adjusted: float, gain: float, is_asked: bool
) -> None:
    """Friction that falls near standstill in thirty moves: p < 1e-20 in rows, 33 % of the error, at p = 0.10."""
    everywhere = those(candidate("stribeck", 1e-20, 0.4), candidate("gravity", 1.0, 0.5))
    in_rows = those(candidate("presliding", 1.0, 0.2), candidate("stribeck", adjusted, gain))
    assert asked(in_rows, everywhere, share) == (["stribeck"] if is_asked else [])


def test_only_the_best_of_those_that_rows_see_is_asked(asked: Asked) -> None:
    """Each costs a fit, and all but one of them resemble that one."""
    lag, stribeck = candidate("frictional-lag", 1e-20, 0.4), candidate("stribeck", 1e-20, 0.3)
    both = those(candidate("drift", 0.5, 0.5), lag, stribeck)
    assert asked(both, both, 0.6) == ["frictional-lag"]
    assert asked(both, both, 0.4) == ["frictional-lag", "stribeck"]


def test_what_only_imitates_another_cause_by_the_rows_is_not_asked(asked: Asked) -> None:
    """A lag of viscous friction does what an inertia does that is on no list, and was named for it (10.5 %)."""
    lag = those(candidate("frictional-lag", 1e-20, 0.4))
    assert asked(lag, lag, 0.6) == ["frictional-lag"]
    assert asked(lag, lag, 0.6, ("frictional-lag",)) == []
