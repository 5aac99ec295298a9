"""An inertia that is estimated from a noisy velocity: noise in the momentum must not make it too small."""

import numpy as np
import pytest

import fricmodels
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready

STEP, COUNT, RUN = 0.002, 6000, 750
INERTIA, VISCOUS, COULOMB = 0.02, 0.05, 0.3


def recorded(noise: float, seed: int = 4) -> Recording:
    """Runs so short that forty test functions, each beside the next, are as narrow as they may be."""
    time = STEP * np.arange(COUNT)
    phases = [(1.0, 2.1), (0.5, 5.3), (0.2, 11.0)]
    velocity = sum(a * w * np.cos(w * time) for a, w in phases)
    acceleration = sum(-a * w**2 * np.sin(w * time) for a, w in phases)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity)
    noisy = velocity + noise * np.random.default_rng(seed).standard_normal(COUNT)
    return Recording(
        "noisy", Motion.ROTARY, {"time": time, "torque": torque, "velocity": noisy}, np.arange(COUNT) // RUN
    )


@pytest.mark.parametrize("seed", range(3, 8))
def test_noise_does_not_shrink_an_estimated_inertia(seed: int) -> None:
    """Through the narrowest test functions noise is more than a tenth of the squared momentum."""
    recording = ready(recorded(0.3, seed))
    drive = fricmodels.Drive(fricmodels.Model.of("coulomb-viscous"), None)
    narrow = estimate(drive, recording, width=16, model_velocity=False)[0]
    assert narrow.momentum_noise > 0.1 * float(narrow.momentum @ narrow.momentum)
    problem, found = estimate(drive, recording, model_velocity=False)
    assert problem.momentum_noise < 0.01 * float(problem.momentum @ problem.momentum)
    assert found.parameters["J"] == pytest.approx(INERTIA, rel=0.007)
    assert abs(found.parameters["J"] - INERTIA) < 4.0 * found.standard_errors["J"]


def test_test_functions_are_no_wider_than_they_were_where_the_inertia_is_given() -> None:
    recording = ready(recorded(0.3))
    given = estimate(fricmodels.Drive(fricmodels.Model.of("coulomb-viscous"), INERTIA), recording)[0]
    assert given.test_functions.width == 16
