"""A wave over position that is faster than the rows show well has skirts in what they show, which are no waves."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest

from fricmodels.diagnosis import compare


def test_a_ripple_beyond_what_the_rows_show_well_is_found_at_its_own_number(
    from_benchmarks: Callable[[str], ModuleType],
) -> None:
    """Of 8 per radian the rows show well up to 6.9: its skirt there left 3.1 %, and made another motion worse."""
    case, *_ = from_benchmarks("rough.trials").case_of("single", "torque-ripple", 2, 8101)
    recording = from_benchmarks("rough.record").record(case)
    found = compare(recording, "coulomb-viscous+torque-ripple", case.inertia)
    assert found.estimate.parameters["torque-ripple.k"] == pytest.approx(8.0, rel=1e-3)
    assert found.errors.held_out_percent < 2.0
