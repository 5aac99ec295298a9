"""On rough drives a ripple of the motor torque is none of friction, though that explains nine tenths of it."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest

from fricmodels.diagnosis import diagnose


@pytest.mark.parametrize("index", [8, pytest.param(9, marks=pytest.mark.long)])
def test_a_ripple_that_is_not_on_the_list_gets_no_other_name(
    from_benchmarks: Callable[[str], ModuleType], index: int
) -> None:
    case, listed, _ = from_benchmarks("rough.trials").case_of("single", "torque-ripple", index, 7301)
    recording = from_benchmarks("rough.record").record(case)
    diagnosis = diagnose(recording, "coulomb-viscous", case.inertia, leave_out=listed)
    assert diagnosis.verdict == "unknown-effect"
    assert not diagnosis.findings
