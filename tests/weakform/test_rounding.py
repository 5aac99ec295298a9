"""What is printed of a fit does not hang on the last digits of its sums, though a parameter may change nothing."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from estimators.batch import Batch
from fricmodels.drive import Drive
from fricmodels.fit import Fit
from fricmodels.model import Model
from fricmodels.weakform.equations import projection
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.solve import solve

CASES = {
    # The stick torque falls to the slip torque; then its speed B changes nothing, and steps of it were rounding.
    "an amplitude of zero": ({"torque": "linear"}, 1, "exponential-stick-slip"),
    # Five parameters for what two can do: of six axes of the covariance two were rounding.
    "a covariance with few digits": (
        {"motion": "point-to-point", "inertia": "estimated"},
        0,
        "coulomb-viscous+stribeck",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_fit_does_not_hang_on_the_last_digit(case: str, from_benchmarks: Callable[[str], ModuleType]) -> None:
    of_cell, number, model = CASES[case]
    cell = from_benchmarks("known_drives").Cell(**of_cell)
    recording = cell.recording(number)
    drive = Drive(Model.parse(model), cell.drive.inertia)
    rng = np.random.default_rng(0)

    def fitted(size: float) -> Fit:
        changed = {
            name: recording[name] * (1.0 + size * rng.standard_normal(len(recording)))
            for name in ("torque", "velocity")
        }
        return Batch().fit(drive, recording.with_channels(**changed))

    first, again = fitted(0.0), fitted(2e-16)
    assert first.parameters == pytest.approx(again.parameters, rel=1e-6)
    assert first.standard_errors == pytest.approx(again.standard_errors, rel=2e-3)
    assert {key: why.split(",")[0] for key, why in first.not_identified.items()} == {
        key: why.split(",")[0] for key, why in again.not_identified.items()
    }


@pytest.fixture
def without_peak(from_benchmarks: Callable[[str], ModuleType]) -> WeakFormProblem:
    """The rows of a drive whose friction has no peak at rest, for a law that has one."""
    recording = from_benchmarks("known_drives").Cell(torque="linear").recording(1)
    drive = Drive(Model.parse("exponential-stick-slip"), 1.8)
    return WeakFormProblem.of(drive, recording, {"K_v": 6.0, "K_c": 9.0, "C": 9.0, "B": 10.0}, 64)


@pytest.mark.parametrize("start", [0.5, 1.0])
def test_what_changes_nothing_stays_where_it_is(without_peak: WeakFormProblem, start: float) -> None:
    found = solve(without_peak, Plan(start={"B": start}), timing=False)
    assert found.parameters["K_c"] == pytest.approx(found.parameters["C"], rel=1e-12)
    assert found.parameters["B"] == start
    assert found.undetermined.shape[1] == 1


def test_of_starts_that_leave_the_same_the_first_is_taken(without_peak: WeakFormProblem) -> None:
    least_squares, search = projection(without_peak, Plan(), timing=False)
    points = search.combinations()
    costs = np.array([least_squares.cost(point) for point in points])
    same = np.flatnonzero(costs <= (1.0 + 1e-9) * costs.min())
    assert least_squares.best_start(search) == points[same[0]]
