"""What a ladder has searched for, or fitted, is not done again, and is the same when it is asked for once more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import compare, journal
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform import estimate as estimates

Made = Callable[..., Recording]
HIDDEN = {"stribeck.F_s": 3.0, "stribeck.omega_s": 1.0, "stribeck.delta": 1.0}
FEW = ("stribeck", "cogging", "gravity")


def test_a_search_in_the_same_rows_is_made_once(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    fitted = compare(made("coulomb-viscous+stribeck", HIDDEN), "coulomb-viscous")
    made_anew: list[str] = []
    search = journal.search

    def counted(*given):
        made_anew.append(given[2].name)
        return search(*given)

    monkeypatch.setattr(journal, "search", counted)
    first, again = (
        candidate_tests(replace(fitted.problem), fitted.estimate.parameters, only=FEW).tested for _ in range(2)
    )
    assert made_anew
    assert len(made_anew) == len(set(made_anew))
    assert [test.name for test in first] == [test.name for test in again]
    for one, other in zip(first, again, strict=True):
        assert one.found.nonlinear == other.found.nonlinear
        np.testing.assert_array_equal(one.found.columns, other.found.columns)
    before = len(made_anew)
    beside = fitted.problem.columns(fitted.problem.alone(first[0].effect), first[0].found.nonlinear)[0]
    candidate_tests(replace(fitted.problem), fitted.estimate.parameters, only=FEW, also=beside)
    assert len(made_anew) > before  # another question


def test_the_smaller_model_of_a_search_for_starts_is_fitted_once(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    recording = made("coulomb-viscous+stribeck", HIDDEN)
    larger, smaller = (Drive(Model.parse(f"coulomb-viscous{more}")) for more in ("+stribeck", ""))
    expected = estimates.estimate(larger, recording)[1]
    names: list[str] = []
    anew = estimates._estimated

    def counted(drive, *given, **further):
        names.append(drive.model.name)
        return anew(drive, *given, **further)

    monkeypatch.setattr(estimates, "_estimated", counted)
    assert estimates.estimate(larger, recording)[1] == expected
    assert names == [larger.model.name]
    kept = estimates._known_fits(recording)
    rows, fit = estimates._of_smaller(smaller, recording, {}, None)
    assert kept
    assert fit == estimates.estimate(smaller, recording)[1]
    assert rows.rows == estimates.estimate(smaller, recording)[0].rows
