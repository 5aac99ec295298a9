"""The motor torque that a fit explains: where friction is a straight line over it, and where it is not."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.weakform.explained import explained_torque

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
