"""An effect that something hid: a channel, a torque's past, a look-alike, few events, or a part of it that is zero."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import pytest

from fricmodels.diagnosis import diagnose


@pytest.mark.parametrize(
    ("kind", "name", "index", "seed", "names"),
    [
        # Beside that of the torque more than its own channel.
        pytest.param("beside", "droop", 9, 3701, ("presliding",), marks=pytest.mark.long),
        # Slow: the torque's past says all of it, whatever its form.
        pytest.param("single", "presliding", 3, 3701, ("presliding",), marks=pytest.mark.long),
        # It showed only beside a wrong torque constant, and that is nothing once the wave is in the model.
        pytest.param("single", "torque-ripple", 4, 4801, ("torque-ripple",), marks=pytest.mark.long),
        # Fitted, a spring leaves less of the recording, and is nothing in the rows of all motion beside the loss.
        ("single", "directional-efficiency", 2, 5201, ("directional-efficiency", "stiffness", "torque-gain")),
        # Few steps hold it: rows are sure of it, and not of its gain.
        ("single", "nonlinear-viscous", 0, 7701, ("nonlinear-viscous",)),
        # Few strokes pass a bump: what walks explains far less of it than the place does, and hid the offset.
        ("beside", "bump", 3, 8101, ("torque-offset",)),
        # A jump in the friction beside |acceleration|: a walk hid it that nothing but the other cause made.
        pytest.param("beside", "absolute-acceleration", 5, 8301, ("step-change",), marks=pytest.mark.long),
        # Its falling part is zero, and its viscous part trades with the lag.
        ("single", "frictional-lag", 2, 8001, ("frictional-lag",)),
    ],
)
def test_it_is_named(
    from_benchmarks: Callable[[str], ModuleType], kind: str, name: str, index: int, seed: int, names: tuple[str, ...]
) -> None:
    case, *_ = from_benchmarks("rough.trials").case_of(kind, name, index, seed)
    recording = from_benchmarks("rough.record").record(case)
    found = diagnose(recording, "coulomb-viscous", case.inertia).findings
    assert [one.names for one in found] == [names]
