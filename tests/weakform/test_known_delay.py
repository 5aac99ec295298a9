"""A delay is known no better than the instants of the samples, and no simpler case is taken for it."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.recording import Recording
from fricmodels.weakform import cases
from fricmodels.weakform.known_delay import TRUE_TO, variance_of_instants
from fricmodels.weakform.nonlinear import Plan

MODEL, DELAY = "coulomb-viscous+sensor-delay", "sensor-delay.T"


def test_a_delay_that_rows_know_far_better_is_known_to_a_twentieth_of_a_sample(
    made: Callable[..., Recording],
) -> None:
    recording = made(noise=1e-4)
    errors = compare(recording, MODEL, 2.0).estimate.standard_errors
    assert TRUE_TO <= errors[DELAY] / recording.interval < 1.2 * TRUE_TO
    plain = compare(recording, "coulomb-viscous", 2.0).estimate.standard_errors
    assert all(errors[key] < 5.0 * plain[key] for key in ("K_v", "K_c"))


@pytest.mark.parametrize("held", [(), (DELAY,)])
def test_only_a_delay_that_is_fitted_has_their_variance(made: Callable[..., Recording], held: tuple[str, ...]) -> None:
    problem = compare(made(noise=0.1), MODEL, 2.0).problem
    expected = np.where(
        [key == DELAY and not held for key in problem.drive.keys], (TRUE_TO * problem.recording.interval) ** 2, 0.0
    )
    np.testing.assert_allclose(variance_of_instants(problem, held), expected)


@pytest.mark.parametrize(("delay", "taken"), [(None, "exact"), (DELAY, "shifted")])
@pytest.mark.parametrize(("odds", "strong"), [(2.0, False), (4.0, True)])
def test_beside_a_delay_the_most_probable_case_is_taken(
    monkeypatch: pytest.MonkeyPatch, delay: str | None, taken: str, odds: float, strong: bool
) -> None:
    """A shift by 7 to 1 is no strong evidence, one by 55 to 1 is: without a delay only that is taken."""
    problem: Any = SimpleNamespace(drive=SimpleNamespace(model=SimpleNamespace(delay=delay)))

    class Fit:
        feedback, again = None, Plan()

        def __init__(self, name: str) -> None:
            self.name, self.problem = name, problem

        def once_more(self, _: Plan, *, timing: bool) -> Fit:
            return Fit("shifted" if timing else "exact")

        @property
        def with_shift(self) -> Fit:
            return Fit("shifted")

        def changed(self, **_: object) -> Fit:
            return self

    monkeypatch.setattr(cases, "log_odds_of_exact", lambda _: 0.0)
    monkeypatch.setattr(cases, "log_odds_of_a_shift", lambda _: odds)
    monkeypatch.setattr(cases, "_may_be_held", lambda _: False)
    monkeypatch.setattr(cases, "nearly_unshifted", lambda *_: Fit("nearly"))
    monkeypatch.setattr(cases, "nearly_exact", lambda *_: Fit("nearly"))
    found: Any = Fit("found")
    chosen: Any = cases.with_or_without_shift(found, Plan())
    assert chosen.name == ("shifted" if strong else taken)
