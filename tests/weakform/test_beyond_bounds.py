"""What ends at its bound, and would lie elsewhere: the number that tells what is wrong with a log is said."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.remarks import remarks_on
from fricmodels.recording import Recording

Made = Callable[..., Recording]
INERTIA = 2.0


@pytest.mark.parametrize("inertia", [INERTIA, None])
def test_a_viscous_friction_that_would_push_is_told(made: Made, inertia: float | None) -> None:
    """As of a torque that was logged at another instant than the motion that a controller answered with it."""
    clean = made(samples=6000)
    true = compare(clean, "coulomb-viscous", inertia).estimate.parameters["K_v"]
    pushed = clean.with_channels(derived=False, torque=clean.torque - (true + 0.7) * clean.velocity)
    found = compare(pushed, "coulomb-viscous", inertia)
    assert found.estimate.parameters["K_v"] == 0.0
    assert found.estimate.beyond["K_v"] == pytest.approx(-0.7, rel=0.15)
    assert remarks_on(found)["K_v"].startswith("at its bound; about -0.")
    assert remarks_on(found)["K_v"].endswith("without bounds")


def test_nothing_is_told_of_what_may_be_at_its_bound(made: Made) -> None:
    clean = made(samples=6000, noise=0.05)
    true = compare(clean, "coulomb-viscous", INERTIA).estimate.parameters["K_v"]
    none = clean.with_channels(derived=False, torque=clean.torque - true * clean.velocity)
    found = compare(none, "coulomb-viscous", INERTIA).estimate
    assert abs(found.parameters["K_v"]) < 3.0 * found.standard_errors["K_v"]
    assert not found.beyond
