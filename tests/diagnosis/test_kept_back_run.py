"""What only a run that is kept back shows is in no row of the fit, and comes near to what remains."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

INERTIA, VISCOUS, COULOMB, OFFSET = 0.05, 0.1, 0.6, -0.4


def record(different: int) -> Recording:
    """Return four runs of a drive, in one of which the torque has a constant."""
    rng, time = np.random.default_rng(0), 0.002 * np.arange(2500)
    runs = []
    for number in range(4):
        phase = rng.uniform(0.0, 6.0, 2)
        velocity = 3.0 * np.sin(4.0 * time + phase[0]) + 2.0 * np.sin(9.0 * time + phase[1])
        rate = 12.0 * np.cos(4.0 * time + phase[0]) + 18.0 * np.cos(9.0 * time + phase[1])
        torque = INERTIA * rate + VISCOUS * velocity + COULOMB * np.sign(velocity)
        torque += OFFSET * (number == different) + 0.01 * rng.standard_normal(len(time))
        runs.append((time, velocity + 1e-3 * rng.standard_normal(len(time)), torque))
    stamps, velocity, torque = map(np.concatenate, zip(*runs, strict=True))
    channels = {"time": stamps, "velocity": velocity, "torque": torque}
    return Recording("runs", Motion.ROTARY, channels, np.repeat(np.arange(4), len(time)))


def test_the_constant_of_a_run_that_was_not_fitted_comes_nearest() -> None:
    found = diagnose(record(different=2), "coulomb-viscous", INERTIA)
    assert found.verdict == "unknown-effect"
    assert found.comparison.test.run_numbers.tolist() == [2]
    rest = found.remaining
    assert rest is not None
    assert rest.nearest[0].name == "run-offset"
    assert found.comparison.errors.held_out_percent > 30.0
    assert rest.nearest[0].held_out_percent == pytest.approx(found.comparison.errors.percent, rel=0.1)


@pytest.mark.parametrize("different", [0, 3])
def test_that_of_a_run_that_was_fitted_is_named(different: int) -> None:
    found = diagnose(record(different), "coulomb-viscous", INERTIA)
    assert [one.names for one in found.findings] == [("run-offset",)]
