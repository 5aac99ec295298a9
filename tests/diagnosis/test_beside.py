"""The look-alikes of an effect are those that it has beside all others of the ladder."""

from __future__ import annotations

import pytest
from tests.conftest import Made

from fricmodels.diagnosis import improve
from fricmodels.diagnosis.ladder import added


@pytest.mark.parametrize("given", [1.2, pytest.param(3.2, marks=pytest.mark.long)])
def test_those_that_only_stood_for_the_other_effect_are_taken_back(made: Made, given: float) -> None:
    """A wrong inertia alone leaves an offset, and so do other effects that then seem to do as much as it."""
    recording = made("coulomb-viscous+torque-offset", {"torque-offset.tau_0": 1.2}, noise=0.5, samples=4000)
    ladder = improve(recording, "coulomb-viscous", given)
    classes = [set(finding.names) for finding in added(ladder)]
    assert sorted(map(sorted, classes)) in (
        [["asymmetry", "torque-offset"], ["inertia-error"]],
        [["asymmetry", "torque-offset"], ["inertia-error", "torque-gain"]],
    )
