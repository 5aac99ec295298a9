"""Climbing: summits are found along narrow ridges, within bounds, whatever the units."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.weakform.optimise import ROUNDS, coordinate_search, halved, multistart_nelder_mead, refine

Point = tuple[float, ...]
POSITIVE, SIGNED = (1e-12, np.inf), (-0.9, 0.9)


def test_a_walk_climbs_to_the_top_by_ratios_and_by_steps() -> None:
    bounds = [(0.0, np.inf), (-np.inf, np.inf)]

    def hill(point: tuple[float, ...]) -> float:
        return -float(np.log(point[0] / 2.7) ** 2 + (point[1] - 0.3) ** 2)

    top = coordinate_search(hill, (2.0, 0.0), bounds, [2.0, -1.0])
    assert top[0] == pytest.approx(2.7, rel=0.02)
    assert top[1] == pytest.approx(0.3, abs=0.02)


def test_a_walk_follows_a_valley_that_runs_between_the_axes() -> None:
    bounds = [(0.0, np.inf)] * 2

    def ridge(point: tuple[float, ...]) -> float:
        along, across = np.log(point[0] * point[1] / 36.0), np.log(point[0] / point[1])
        return -float(along**2 + 5 * across**2)

    top = coordinate_search(ridge, (1.0, 1.0), bounds, [2.0, 2.0])
    assert top[0] == pytest.approx(6.0, rel=0.1)
    assert top[1] == pytest.approx(6.0, rel=0.1)


def test_a_walk_stays_within_bounds_and_never_goes_down() -> None:
    bounds = [(0.5, 2.0)]
    seen: list[float] = []

    def slope(point: tuple[float, ...]) -> float:
        seen.append(point[0])
        return point[0]

    assert coordinate_search(slope, (1.0,), bounds, [4.0]) == (2.0,)
    assert 0.5 <= min(seen) <= max(seen) <= 2.0
    assert coordinate_search(lambda point: -abs(point[0] - 1.0), (1.0,), bounds, [1.3]) == (1.0,)


@pytest.mark.parametrize("first", [1, 3, 4])
def test_a_search_that_is_interrupted_goes_on_to_the_same_end(first: int) -> None:
    bounds, spacing = [(0.0, np.inf), (-np.inf, np.inf)], [2.0, -1.0]

    def hill(point: Point) -> float:
        return -float(np.log(point[0] / 2.7) ** 2 + (point[1] - 0.3 * point[0]) ** 2)

    at_once = coordinate_search(hill, (2.0, 0.0), bounds, spacing)
    begun = coordinate_search(hill, (2.0, 0.0), bounds, spacing, first)
    assert begun != at_once
    assert coordinate_search(hill, begun, bounds, halved(spacing, first), ROUNDS - first) == pytest.approx(at_once)
    assert halved(spacing, 2) == [2.0**0.25, -0.25]


# ---- simplexes --------------------------------------------------------------------------------------------------


def ridge(point: Point) -> float:
    """A curved ridge in the logarithm of one parameter and in another of either sign; its summit is at (3, 0.4, 20)."""
    along, across, far = np.log(point[0] / 3), (point[1] - 0.4) / 0.2, np.log(point[2] / 20)
    return -float((along - across**2) ** 2 * 30 + 0.5 * along**2 + 0.1 * across**2 + (far - along) ** 2)


def test_simplexes_find_the_top_of_a_curved_ridge() -> None:
    starts = [(1.0, 0.0, 5.0), (10.0, -0.2, 5.0), (1.0, 0.0, 50.0)]
    found = multistart_nelder_mead(ridge, starts, [POSITIVE, SIGNED, POSITIVE], [2.0, -0.2, 2.0])
    np.testing.assert_allclose(found, (3.0, 0.4, 20.0), rtol=0.02)


def test_the_best_of_several_summits_is_taken() -> None:
    def two(point: Point) -> float:
        x, y, z = np.log(point)
        return float(np.exp(-(x**2 + y**2 + z**2)) + 2 * np.exp(-((x - 4) ** 2 + (y - 4) ** 2 + (z + 4) ** 2)))

    starts = [(1.1, 1.0, 1.0), (30.0, 30.0, 0.03)]
    for order in (starts, starts[::-1]):
        found = multistart_nelder_mead(two, order, [POSITIVE] * 3, [2.0] * 3)
        np.testing.assert_allclose(np.log(found), (4.0, 4.0, -4.0), atol=0.05)


def test_simplexes_stay_within_bounds_and_leave_what_makes_no_difference() -> None:
    seen: list[Point] = []

    def outward(point: Point) -> float:
        seen.append(point)
        return point[0] + point[1]

    bounded = [(0.5, 7.0), SIGNED, POSITIVE]
    found = multistart_nelder_mead(outward, [(1.0, 0.0, 3.0)], bounded, [2.0, -0.2, 1.0])
    assert found == pytest.approx((7.0, 0.9, 3.0))
    assert all(0.5 <= p <= 7.0 and -0.9 <= s <= 0.9 and other == 3.0 for p, s, other in seen)


def test_the_summit_does_not_depend_on_the_units() -> None:
    starts = [(1.0, 0.05, 5.0), (10.0, -0.2, 5.0)]
    parameters, spacing = [POSITIVE, SIGNED, POSITIVE], [2.0, -0.2, 2.0]
    one = multistart_nelder_mead(ridge, starts, parameters, spacing)
    other = multistart_nelder_mead(
        lambda p: ridge((p[0] / 1e4, p[1], p[2])), [(a * 1e4, b, c) for a, b, c in starts], parameters, spacing
    )
    np.testing.assert_allclose(other, (one[0] * 1e4, one[1], one[2]), rtol=1e-6)


def test_what_is_not_worth_it_is_not_begun_anew() -> None:
    trials: list[int] = []
    for worth in (-np.inf, 1.0):
        seen: list[Point] = []

        def counted(point: Point, seen: list[Point] = seen) -> float:
            seen.append(point)
            return ridge(point)

        multistart_nelder_mead(counted, [(1.0, 0.0, 5.0)], [POSITIVE, SIGNED, POSITIVE], [2.0, -0.2, 2.0], worth)
        trials.append(len(seen))
    assert trials[1] < 50 < trials[0], "no simplex, for the ridge is nowhere above zero"


def test_what_is_given_up_leaves_the_best_start_wherever_the_simplexes_had_come() -> None:
    starts = [(1.0, 0.05, 5.0), (3.0, 0.0, 4.0)]

    def low(point: Point) -> float:
        return 1.0 / (1.0 + sum((x - 2.0) ** 2 for x in point))

    best = max(starts, key=low)
    for worth in (2.0, 100.0):  # given up after the second look, and after the first
        parameters, spacing = [POSITIVE, SIGNED, POSITIVE], [2.0, -0.2, 2.0]
        assert multistart_nelder_mead(low, starts, parameters, spacing, worth) == best
    assert low(multistart_nelder_mead(low, starts, [POSITIVE, SIGNED, POSITIVE], [2.0, -0.2, 2.0])) > low(best)


@pytest.mark.parametrize(("share", "begun"), [(1 / 15, True), (1 / 17, False)])
def test_what_no_start_comes_near_is_not_begun(share: float, begun: bool) -> None:
    starts, asked = [(1.0, 0.0, 5.0), (10.0, -0.2, 5.0)], set()

    def value(point: Point) -> float:
        asked.add(point)
        return 1.0

    assert (
        multistart_nelder_mead(value, starts, [POSITIVE, SIGNED, POSITIVE], [2.0, -0.1, 2.0], 1.0 / share) == starts[0]
    )
    assert (asked > set(starts)) is begun


def test_patience_begins_anew_where_it_did_not_help() -> None:
    trials: list[int] = []
    for patience in (0, 1):
        seen: list[Point] = []

        def counted(point: Point, seen: list[Point] = seen) -> float:
            seen.append(point)
            return 2.0 - float(sum(abs(x - 1.0) for x in point))

        multistart_nelder_mead(counted, [(1.0, 1.0, 1.0)], [POSITIVE] * 3, [2.0] * 3, patience=patience)
        trials.append(len(seen))
    assert trials[1] > 1.5 * trials[0], "from the summit itself nothing is gained"


def test_nothing_free_leaves_the_best_start() -> None:
    assert multistart_nelder_mead(sum, [(1.0, 2.0), (3.0, 1.0)], [POSITIVE] * 2, [1.0, 1.0]) == (3.0, 1.0)


@pytest.mark.parametrize("begin", [(2.6, 0.28), (2.9, 0.35), (2.7, 0.1)])
def test_refinement_ends_at_the_top_whatever_the_path(begin: Point) -> None:
    """On a ridge that is neither straight nor symmetric."""

    def ridge(point: Point) -> float:
        along = np.log(point[0] / 2.7)
        return -float(along**2 + along**3 / 2 + 5 * (point[1] - 0.3 - along) ** 2 + (point[1] - 0.3) ** 4)

    top = refine(ridge, begin, [(0.1, 10.0), (-1.0, 1.0)], [2.0, -1.0])
    assert top == pytest.approx((2.7, 0.3), abs=1e-6)


def test_refinement_leaves_a_parameter_at_its_bound_and_never_goes_down() -> None:
    seen: list[float] = []

    def slope(point: Point) -> float:
        seen.append(point[0])
        return point[0] - (point[1] - 1.0) ** 2

    begin = (2.0, 1.1)
    top = refine(slope, begin, [(0.5, 2.0), (0.1, 10.0)], [2.0, 2.0])
    assert top == pytest.approx((2.0, 1.0), abs=1e-6)
    assert max(seen) <= 2.0
    assert slope(top) >= slope(begin)


def test_refinement_leaves_alone_what_makes_no_difference() -> None:
    assert refine(lambda point: 1.0, (2.0, 3.0), [(0.5, 5.0)] * 2, [2.0, 1.0]) == (2.0, 3.0)
