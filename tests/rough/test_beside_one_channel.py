"""An effect that a second cause hid: its channel, or the past of the torque, did as much as it by another form."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest

from fricmodels.diagnosis import diagnose


@pytest.mark.parametrize(
    ("kind", "name", "index", "effect"),
    [
        ("beside", "droop", 9, "presliding"),  # beside the channel of the torque it does more than that of its own
        ("single", "presliding", 3, "presliding"),  # slow motion: the torque's past says all of it, whatever its form
    ],
)
def test_it_is_named(
    from_benchmarks: Callable[[str], ModuleType], kind: str, name: str, index: int, effect: str
) -> None:
    case, *_ = from_benchmarks("rough.trials").case_of(kind, name, index, 3701)
    recording = from_benchmarks("rough.record").record(case)
    found = diagnose(recording, "coulomb-viscous", case.inertia).findings
    assert [one.names for one in found] == [(effect,)]
