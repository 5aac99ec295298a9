"""A wrong inertia beside an offset: both get their names, with their true look-alikes, and nothing else gets one."""

from __future__ import annotations

import pytest
from tests.conftest import Made

from fricmodels.diagnosis import improve
from fricmodels.diagnosis.ladder import added


@pytest.mark.long
@pytest.mark.parametrize("given", [1.2, 3.2])
def test_two_causes_are_named_and_no_third(made: Made, given: float) -> None:
    """As a wrong torque constant it was less exact than as a wrong inertia, and the rest was called a compliance."""
    recording = made("coulomb-viscous+torque-offset", {"torque-offset.tau_0": 1.2}, noise=0.5, samples=4000)
    ladder = improve(recording, "coulomb-viscous", given)
    classes = [set(finding.names) for finding in added(ladder)]
    assert sorted(map(sorted, classes)) in (
        [["asymmetry", "torque-offset"], ["inertia-error"]],
        [["asymmetry", "torque-offset"], ["inertia-error", "torque-gain"]],
    )
