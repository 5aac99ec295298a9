"""The quick part of benchmarks/coverage_matrix.py: every interval holds, or there is none and a reason why."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest

REPLICATIONS = 6
ESTIMATORS = ("detchmendy-sridhar", "ekf", "rls", "constant-velocity")


@pytest.fixture(scope="module")
def matrix(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    return from_benchmarks("coverage_matrix")


@pytest.mark.parametrize("number", [3, *(pytest.param(number, marks=pytest.mark.long) for number in (0, 4))])
def test_intervals_hold_or_say_why_not(matrix: ModuleType, number: int) -> None:
    cell = matrix.quick_cells()[number]
    rows = matrix.collected([cell], ESTIMATORS, REPLICATIONS, 1, None)
    for estimator in ESTIMATORS:
        own = [row for row in rows if row["estimator"] == estimator]
        for p in cell.drive.parameters:
            found = matrix.figures(own, p.key, cell.truth[p.key])
            assert found.fits == REPLICATIONS
            assert found.good, (cell.name, estimator, p.key, found)


def test_a_held_torque_is_not_simulated_half_a_sample_early(matrix: ModuleType) -> None:
    """A velocity that is simulated so has the shift in it, and hides it: K_v was off by up to nine standard errors."""
    cell = matrix.Cell(motion="sine")
    for row in matrix.collected([cell], ("batch",), 5, 1, None):
        for key, error in row["errors"].items():
            assert abs(row["values"][key] - cell.truth[key]) < 3.0 * error


@pytest.mark.long
def test_steps_of_an_encoder_are_in_the_interval(matrix: ModuleType) -> None:
    """Under a sine their error is the same in every cycle, and no residual shows it: 9 and 10 of 35 were covered."""
    cell = matrix.Cell(noise="encoder-4096", motion="sine")
    rows = matrix.collected([cell], ("batch",), REPLICATIONS, 1, None)
    for key in ("K_v", "K_c"):
        assert matrix.figures(rows, key, cell.truth[key]).covered >= REPLICATIONS - 2


def test_replications_do_not_depend_on_their_order(matrix: ModuleType) -> None:
    one, other = matrix.quick_cells()[:2]
    first = one.recording(3).velocity
    other.recording(0)
    assert (one.recording(3).velocity == first).all()
    assert (one.recording(4).velocity != first).any()


def test_a_wrong_standard_error_is_seen(matrix: ModuleType) -> None:
    rows = [
        {"values": {"a": 1.0 + 0.1 * (-1) ** i}, "errors": {"a": 0.01}, "reasons": {}, "bound": {}} for i in range(20)
    ]
    assert not matrix.figures(rows, "a", 1.0).good
    silent = [{**row, "errors": {}} for row in rows]
    assert not matrix.figures(silent, "a", 1.0).good
    said = [{**row, "errors": {}, "reasons": {"a": "not identified"}} for row in rows]
    assert matrix.figures(said, "a", 1.0).good
