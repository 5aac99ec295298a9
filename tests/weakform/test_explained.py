"""The motor torque that a fit explains: where friction is a straight line over it, and where it is not."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import Made

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.explained import explained_torque, torque_by_acceleration

RNG = np.random.default_rng(5)
TRUE = RNG.normal(0.0, 1.0, 500)
SIGN = np.sign(RNG.normal(0.0, 1.0, 500))


@pytest.mark.parametrize("exponent", [1.0, 1.3, 1.6, 2.0])
def test_the_torque_that_the_equation_asks_for_is_found(exponent: float) -> None:
    def friction(torque: Array) -> Array:
        return np.asarray(0.1 * np.abs(torque) ** exponent * SIGN + 0.05 * SIGN)

    unmoved = TRUE - friction(TRUE)
    recorded = TRUE + 0.02 * RNG.standard_normal(len(TRUE))
    assert explained_torque(unmoved, recorded, friction) == pytest.approx(TRUE, abs=1e-6)


def test_a_gain_is_taken_off_in_one_step() -> None:
    seen = []

    def friction(torque: Array) -> Array:
        seen.append(torque)
        return 0.25 * torque

    assert explained_torque(0.75 * TRUE, TRUE + 1.0, friction) == pytest.approx(TRUE, rel=1e-12)
    assert len(seen) == 3


def test_the_inertia_in_an_explained_torque_is_that_of_drive_and_effects_over_the_gain() -> None:
    drive = Drive(Model.parse("coulomb-viscous+inertia-error+torque-gain"), 2.0)
    values = {"K_v": 0.5, "K_c": 3.0, "inertia-error.dJ": 0.4, "torque-gain.g": -0.25}
    assert torque_by_acceleration(drive, values) == pytest.approx(2.4 / 0.75)
    assert torque_by_acceleration(Drive(Model.parse("coulomb-viscous"), 2.0), values) == 2.0


@pytest.mark.parametrize("seed", range(3))
def test_a_wrong_torque_constant_is_as_exact_as_a_wrong_inertia(made: Made, seed: int) -> None:
    """What the smoothed acceleration loses of fast motion is not in the torque: g was off by nine standard errors."""
    recording = made(noise=0.5, samples=4000, seed=seed)
    _, gain = estimate(Drive(Model.parse("coulomb-viscous+torque-gain"), 1.2), recording)
    _, inertia = estimate(Drive(Model.parse("coulomb-viscous+inertia-error"), 1.2), recording)
    for found, key, true in ((gain, "torque-gain.g", -0.4), (inertia, "inertia-error.dJ", 0.8)):
        assert abs(found.parameters[key] - true) < 4.0 * found.standard_errors[key]
        assert found.standard_errors[key] < 2e-3
