"""The smallest visible effect: the critical value by which it is said, and when it is none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import fdtrc

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.power import critical_f, visibility
from fricmodels.dimension import Motion
from fricmodels.recording import Recording


@pytest.mark.parametrize("level", [0.5, 0.01, 1e-6, 1e-20])
@pytest.mark.parametrize(("q", "n"), [(1, 1), (1, 30), (3, 12), (7, 200)])
def test_the_critical_value_is_exceeded_at_its_level(level: float, q: int, n: int) -> None:
    assert fdtrc(q, n, critical_f(level, q, n)) == pytest.approx(level, rel=1e-8)


def test_it_is_the_printed_one() -> None:
    """F(2, 10) at 5 %, as in any table."""
    assert critical_f(0.05, 2, 10) == pytest.approx(4.103, abs=5e-4)


def test_no_size_is_more_than_all_of_the_torque() -> None:
    """Few rows, of which noise is most: then it is said that nothing less would stand out."""
    rng = np.random.default_rng(3)
    time = 0.034 * np.arange(335)
    position = 0.03 * np.sin(1.7 * time) + 0.008 * np.sin(4.1 * time + 1.0)
    rate = -0.03 * 1.7**2 * np.sin(1.7 * time) - 0.008 * 4.1**2 * np.sin(4.1 * time + 1.0)
    channels = {"time": time, "position": np.round(position, 3), "torque": 8.0 * rate + rng.standard_normal(335)}
    here = compare(Recording("beam", Motion.LINEAR, channels, np.zeros(335, dtype=np.int64)), "coulomb-viscous")
    rows = visibility(candidate_tests(here.problem, here.estimate.parameters), ())
    assert not any(row.smallest_percent > 100.0 for row in rows.values())
    assert any("more than all of the motor torque" in row.missing for row in rows.values())
