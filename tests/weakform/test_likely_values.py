"""How far a parameter may be off whose squared error is a stair."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fricmodels.weakform.inference import NORMAL_95
from fricmodels.weakform.likely_values import likely_error, likely_points

UNBOUNDED = (-math.inf, math.inf)


@pytest.mark.parametrize("begun", [1e-6, 0.003, 0.01])
def test_of_a_parabola_it_is_the_standard_error(begun: float) -> None:
    """Of unit independent errors with N equations: S = N + ((p − 2)/0.01)²; steps that double end within 5 % of it."""
    count, error = 400.0, 0.01
    found = likely_error(lambda p: count + ((p - 2.0) / error) ** 2, 2.0, begun, UNBOUNDED, count)
    assert found == pytest.approx(error, rel=0.05)
    wide = likely_error(lambda p: count + ((p - 2.0) / error) ** 2, 2.0, 0.03, UNBOUNDED, count)
    assert wide == 0.0, "a standard error that is more says all of it"


def test_it_does_not_hang_on_the_slope_of_a_small_step() -> None:
    """Steps of 0.001 on the same parabola: each falls steeply, as to a thousandth of the error, and none leads on."""
    count, error, step = 400.0, 0.01, 1e-3

    def cost(p: float) -> float:
        whole = round((p - 2.0) / step)
        return count + (whole * step / error) ** 2 + 0.02 * abs((p - 2.0) / step - whole)

    assert likely_error(cost, 2.0, 1e-5, UNBOUNDED, count) == pytest.approx(error, rel=0.1)


def test_bounds_and_the_further_side_count() -> None:
    count = 100.0

    def cost(p: float) -> float:
        return count + ((p - 1.0) / (0.1 if p > 1.0 else 0.02)) ** 2

    assert likely_error(cost, 1.0, 0.01, UNBOUNDED, count) == pytest.approx(0.1, rel=0.05)
    assert likely_error(cost, 1.0, 0.01, (0.5, 1.05), count) == pytest.approx(0.05 / NORMAL_95, rel=0.1)
    assert likely_error(lambda p: count if p == 1.0 else np.inf, 1.0, 0.01, UNBOUNDED, count) == 0.0


def test_what_parameters_do_together_is_seen() -> None:
    """Of three only two products are known to a hundredth: alone each is, together each goes as far as x² allows."""
    count, error = 400.0, 0.01

    def cost(point: tuple[float, ...]) -> float:
        x, y, z = np.log(np.array(point))
        return float(count + ((x + y) / error) ** 2 + ((y + z) / error) ** 2 + (x / 0.3) ** 2)

    begin = (1.0, 1.0, 1.0)
    alone = likely_error(lambda p: cost((p, 1.0, 1.0)), 1.0, error, UNBOUNDED, count)
    assert alone < 1.1 * error
    found = likely_points(cost, begin, [(0.0, math.inf)] * 3, [0.0] * 3, count, 1000)
    assert all(cost(point) <= cost(begin) * (1.0 + NORMAL_95**2 / count) for point in found)
    furthest = np.abs(np.log(np.array(found))).max(axis=0)
    assert np.all(furthest > 3.0 * NORMAL_95 * error)
    assert np.all(furthest <= 1.05 * NORMAL_95 * 0.3)


def test_what_stays_is_not_moved_and_bounds_hold() -> None:
    def cost(point: tuple[float, ...]) -> float:
        return 100.0 + (point[0] - 1.0) ** 2 + abs(point[1])

    found = likely_points(cost, (1.0, 5.0, 2.0), [(0.5, 1.25), (0.0, 9.0), (-1.0, 1.0)], [0.0, -1.0, -1.0], 100.0, 10)
    assert {point[1:] for point in found} == {(5.0, 2.0)}
    assert min(point[0] for point in found) == 0.5
    assert max(point[0] for point in found) == 1.25
    assert likely_points(cost, (1.0, 5.0), [(0.5, 1.25), (0.0, 9.0)], [-1.0, -1.0], 100.0, 10) == []


@pytest.mark.parametrize("certain", [1e-3, 0.5, 2.0])
def test_what_leaves_twice_the_squares_is_never_likely(certain: float) -> None:
    """A valley beside the estimate that leaves seventeen times as much, as a contact without its gap does."""

    def cost(point: tuple[float, ...]) -> float:
        return 1.0 + min(sum((p - 1.0) ** 2 for p in point) / 0.01, 16.0)

    points = likely_points(cost, (1.0, 1.0, 1.0), [(1e-6, 1e6)] * 3, [0.0] * 3, certain, 1000)
    assert max(map(cost, points)) < 2.0
    assert likely_error(lambda p: cost((p, 1.0, 1.0)), 1.0, 0.01, (1e-6, 1e6), certain) < 0.1
