"""Rows with a carrier: they show a wave that a test function averages away, and count by how noisy they are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform import carriers
from fricmodels.weakform.carriers import CarrierFunctions
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.row_noise import momentum_noise, noise_impulses

Made = Callable[..., Recording]

FAST = 61.0
WAVE = {"cogging.a": 4.0, "cogging.b": -2.4, "cogging.k": FAST}
TRUE = {"K_v": 0.5, "K_c": 3.0, "J": 2.0}


def test_rows_of_a_carrier_are_no_noisier_than_those_of_the_test_functions(made: Made) -> None:
    problem = WeakFormProblem.of(Drive(Model.parse("coulomb-viscous")), made(noise=2.0), TRUE)
    plain = CarrierFunctions(problem.test_functions, problem.recording, (FAST, 2 * FAST))
    weighted = plain.weighted(problem.quadrature, problem.recording, TRUE["J"])

    def noise(test_functions: CarrierFunctions) -> np.ndarray:
        of_motion = TRUE["J"] * momentum_noise(test_functions, problem.recording)
        of_torque = noise_impulses(test_functions, problem.quadrature, problem.recording)
        return np.sqrt(np.mean((of_motion**2 + of_torque**2).reshape(-1, test_functions.each), axis=0))

    before, after = noise(plain), noise(weighted)
    assert before[1:].min() > 3 * before[0]
    assert after[0] == before[0]
    np.testing.assert_allclose(np.sqrt(np.mean(after[1:].reshape(2, 2) ** 2, axis=1)), after[0], rtol=1e-6)
    # One factor for all rows of a carrier: the equation that they are stays the same.
    ratio = weighted.momentum(problem.recording.velocity) / plain.momentum(problem.recording.velocity)
    torques = (f.torques(problem.quadrature, problem.points.torque[None])[0] for f in (weighted, plain))
    np.testing.assert_allclose(np.divide(*torques), ratio, rtol=1e-9)
    assert len(np.unique(np.round(ratio, 9))) == 3


def test_without_noise_every_row_counts_as_it_is(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = WeakFormProblem.of(Drive(Model.parse("coulomb-viscous")), made(), TRUE)
    plain = CarrierFunctions(problem.test_functions, problem.recording, (FAST,))
    velocity = problem.recording.velocity
    noisy = plain.weighted(problem.quadrature, problem.recording, TRUE["J"])
    assert not np.allclose(noisy.momentum(velocity), plain.momentum(velocity))
    for name in ("momentum_noise", "noise_impulses"):
        monkeypatch.setattr(carriers, name, lambda functions, *_: np.zeros(functions.count))
    quiet = plain.weighted(problem.quadrature, problem.recording, TRUE["J"])
    np.testing.assert_array_equal(quiet.momentum(velocity), plain.momentum(velocity))


def test_where_there_are_no_rows_there_is_nothing_to_weigh(made: Made) -> None:
    problem = WeakFormProblem.of(Drive(Model.parse("coulomb-viscous")), made(), TRUE)
    everywhere = np.ones(len(problem.recording), dtype=bool)
    none = CarrierFunctions(problem.test_functions.clear_of(everywhere), problem.recording, (FAST,))
    assert none.weighted(problem.quadrature, problem.recording, TRUE["J"]).count == 0


@pytest.mark.parametrize("noise", [0.05, 2.0, 10.0])
def test_an_inertia_beside_a_fast_wave_is_not_that_of_noise(made: Made, noise: float) -> None:
    """Where all rows counted alike it came out as 1.52 ± 0.21 in place of 2 with 10 % of noise on the velocity."""
    recording = made("coulomb-viscous+cogging", WAVE, noise=noise)
    drive = Drive(Model.parse("coulomb-viscous+cogging"))
    _, found = estimate(drive, recording, {"cogging.k": FAST})
    error = found.standard_errors
    assert found.parameters["J"] == pytest.approx(TRUE["J"], rel=0.01)
    assert error["J"] < 0.01 * TRUE["J"]
    for key, value in {**TRUE, "cogging.k": FAST}.items():
        if key in found.not_identified:  # 10 % of noise may hide the wave, and the fit says so
            assert (noise, key) == (10.0, "cogging.k")
            continue
        assert abs(found.parameters[key] - value) < 5 * error[key] + 0.005 * value, key
