"""How far a parameter may be off whose squared error is a stair."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fricmodels.weakform.inference import NORMAL_95
from fricmodels.weakform.likely_values import likely_error

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
