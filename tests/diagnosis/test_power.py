"""The critical value by which the smallest visible effect is said."""

from __future__ import annotations

import pytest
from scipy.special import fdtrc

from fricmodels.diagnosis.power import critical_f


@pytest.mark.parametrize("level", [0.5, 0.01, 1e-6, 1e-20])
@pytest.mark.parametrize(("q", "n"), [(1, 1), (1, 30), (3, 12), (7, 200)])
def test_the_critical_value_is_exceeded_at_its_level(level: float, q: int, n: int) -> None:
    assert fdtrc(q, n, critical_f(level, q, n)) == pytest.approx(level, rel=1e-8)


def test_it_is_the_printed_one() -> None:
    """F(2, 10) at 5 %, as in any table."""
    assert critical_f(0.05, 2, 10) == pytest.approx(4.103, abs=5e-4)
