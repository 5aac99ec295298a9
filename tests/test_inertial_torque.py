"""A torque in proportion to the acceleration is an inertia: it needs no derivative, in the rows and in the errors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import filtered_torque_error
from fricmodels.score.bands import torque_errors
from fricmodels.score.proportional import of_acceleration
from fricmodels.split import split
from fricmodels.weakform.equations import equations
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.row_noise import beyond_noise

Made = Callable[..., Recording]
LAW = {"K_v": 0.5, "K_c": 3.0}
DRIVE = Drive(Model.parse("coulomb-viscous"), 2.0)
WITH = Drive(Model.parse("coulomb-viscous+inertia-error"), 1.7)
VALUES = {**LAW, "inertia-error.dJ": 0.3}


def positions(recording: Recording) -> Recording:
    """Return the same motion recorded by an encoder alone."""
    counts = np.round(recording["position"] * 2**16) / 2**16
    channels = {"time": recording.time, "torque": recording.torque, "position": counts}
    return Recording("positions", recording.motion, channels, recording.run)


@pytest.mark.parametrize("of", [Recording.remembering, positions], ids=["velocity", "positions"])
def test_an_inertia_in_two_parts_leaves_the_same_error(made: Made, of: Callable[[Recording], Recording]) -> None:
    """1.7 and 0.3 kg m² as an effect are 2.0, whatever a differentiator would have made of the 0.3."""
    train, test = split(ready(of(made())))
    one, _ = torque_errors(DRIVE, LAW, train, test)
    two, _ = torque_errors(WITH, VALUES, train, test)
    for a, b in zip(one.bands, two.bands, strict=True):
        assert b.percent == pytest.approx(a.percent, rel=1e-6)
        assert b.held_out_percent == pytest.approx(a.held_out_percent, rel=1e-6)
    for part in (train, test):
        np.testing.assert_allclose(
            filtered_torque_error(WITH, VALUES, part, 5), filtered_torque_error(DRIVE, LAW, part, 5), atol=1e-9
        )


def test_the_part_of_a_model_that_is_an_inertia() -> None:
    assert of_acceleration(DRIVE, LAW) == 0.0
    assert of_acceleration(WITH, VALUES) == pytest.approx(0.3)
    link = Drive(Model.parse("coulomb-viscous+joint-compliance"), 2.0)
    values = {**LAW, "joint-compliance.J_l": 0.8, "joint-compliance.omega_n": 40.0, "joint-compliance.zeta": 0.1}
    assert of_acceleration(link, values) == pytest.approx(-0.8)
    gap = Drive(Model.parse("coulomb-viscous+backlash"), 2.0)
    assert of_acceleration(gap, {p.key: 1.0 for p in gap.parameters}) == 0.0, "within a gap only, not everywhere"


def test_the_column_of_an_inertia_is_the_momentum(made: Made) -> None:
    """In the tests of candidates and in the fit alike; the derived acceleration alone is too small."""
    problem = WeakFormProblem.of(DRIVE, ready(made(noise=0.0)), {**LAW, "J": 2.0})
    alone = problem.alone(WITH.model.effects[0])
    derived = problem.integrals(problem.quadrature.recording["acceleration"][None])[0]
    lacks = float(np.max(np.abs(derived - problem.momentum)))
    assert lacks > 1e-4 * float(np.max(np.abs(problem.momentum)))
    np.testing.assert_allclose(problem.columns(alone)[0][0], problem.momentum, atol=0.2 * lacks)
    fitted = WeakFormProblem.of(WITH, ready(made(noise=0.0)), {**VALUES, "J": 1.7})
    rows = equations(fitted, timing=False)
    place = rows.separable.fixed.index(2)
    np.testing.assert_allclose(rows.fixed[place], fitted.momentum, atol=0.2 * lacks)


def test_what_is_noise_of_the_momentum_is_not_taken_for_what_the_derivative_lacks() -> None:
    """The whole difference where there is no noise, none of it where it is nothing but noise, and half between."""
    rng = np.random.default_rng(1)
    lacks, noise, other = rng.standard_normal((3, 100_000))
    derived = 10.0 * rng.standard_normal(100_000)
    for size, share in ((0.0, 1.0), (1.0, 0.5), (1e3, 0.0)):
        momentum = derived + lacks + size * noise
        own, again = beyond_noise(momentum, size * other, derived, derived)
        np.testing.assert_allclose(own, share * (momentum - derived), atol=0.04 * (1 + size))
        np.testing.assert_allclose(again - own, share * size * other, atol=0.1 * (1 + size))
