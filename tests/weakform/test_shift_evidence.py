"""A shift in time that is smaller than a tenth of a sample: taken out where the rows show it, and only there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.cases import with_or_without_shift
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.nonlinear import Plan
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.shift_evidence import log_odds_of_exact, nearly_exact, nearly_unshifted
from fricmodels.weakform.solve import Solved, solve

Made = Callable[..., Recording]
TRUTH = {"J": 2.0, "K_v": 0.5, "K_c": 3.0}
DRIVE = Drive(Model.parse("coulomb-viscous"), 2.0)


def shifted(recording: Recording, samples: float) -> Recording:
    """Return it with the torque recorded so many samples late."""
    course = CubicSpline(recording.time, recording.torque)
    return recording.with_channels(torque=course(recording.time - samples * recording.interval))


def fitted(recording: Recording) -> Solved:
    return solve(WeakFormProblem.of(DRIVE, recording, TRUTH), Plan())


@pytest.mark.parametrize("samples", [-0.08, -0.04, 0.0, 0.04, 0.08])
def test_the_friction_does_not_hang_on_a_small_shift(made: Made, samples: float) -> None:
    """J dω/dt shifted by δ is −J δ d²ω/dt²: under a multisine that looks like a viscous torque."""
    found = estimate(DRIVE, shifted(made(noise=0.2), samples))[1]
    for key in ("K_v", "K_c"):
        assert abs(found.parameters[key] - TRUTH[key]) < 3.0 * found.standard_errors[key] + 0.002 * TRUTH[key]


def test_what_is_not_seen_is_not_taken_out(made: Made) -> None:
    """With 10 % of noise a shift by 0.05 samples is hidden: exact instants stay as probable, and are simpler."""
    for samples in (0.0, 0.05):
        found = fitted(shifted(made(noise=10.0), samples))
        assert abs(log_odds_of_exact(found.with_shift)) < 1.0
        assert with_or_without_shift(found, found.again).plan.shifts == ()


def test_what_is_seen_is_what_it_is_and_what_is_not_is_nothing(made: Made) -> None:
    """n* = S (S + V)⁻¹ n lies between nothing and n: near n for V ≪ S, near nothing for V ≫ S."""
    found = fitted(shifted(made(noise=0.2), 0.07)).with_shift
    interval, place = found.problem.recording.interval, found.nuisances[-1]
    for spread, share in ((1e-4, 1.0), (0.05, 0.5), (10.0, 0.0)):
        own = np.zeros_like(found.spread)
        own[place, place] = (spread * interval) ** 2
        other = replace(found)
        other.__dict__["spread"] = own
        held = nearly_unshifted(other, found.again).plan.shifts
        assert held[0] == 0.0
        assert held[-1] == pytest.approx(share * found.solution.theta[place], rel=1e-3, abs=1e-4 * interval)


def test_what_is_left_of_a_shift_is_in_the_errors(made: Made) -> None:
    """The others move with a shift by G: between two held shifts they differ by G times the difference."""
    found = fitted(made(noise=0.2)).with_shift
    interval = found.problem.recording.interval
    near = nearly_unshifted(found, found.again)
    moved = [
        solve(found.problem, replace(found.again, shifts=(0.0, side * 0.01 * interval))).values for side in (-1.0, 1.0)
    ]
    slope = (moved[1] - moved[0]) / (0.02 * interval)
    own = found.spread[found.nuisances[-1], found.nuisances[-1]]
    true = (0.05 * interval) ** 2
    left = own * true / (own + true)
    assert near.of_shifts is not None
    assert np.all(np.diag(near.of_shifts) >= 0.9 * slope**2 * left)
    free = np.diag(near.covariance) > 0.0
    assert np.all(np.diag(near.covariance)[free] >= np.diag(near.of_shifts)[free])


def test_to_first_order_it_is_the_same(made: Made) -> None:
    found = fitted(shifted(made(noise=0.2), 0.02))
    whole = nearly_unshifted(found.with_shift, found.again)
    exact = found.once_more(found.again, timing=False)
    near = nearly_exact(found.with_shift, exact)
    moved = whole.values - exact.values
    np.testing.assert_allclose(near.values - exact.values, moved, rtol=1e-3, atol=1e-6)
    assert np.any(np.abs(moved) > 1e-4)
    assert near.of_shifts is not None
    assert whole.of_shifts is not None
    np.testing.assert_allclose(near.of_shifts, whole.of_shifts, rtol=1e-3)
