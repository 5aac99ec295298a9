"""What a law's bound keeps it from, and whether that hides what is missing."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose
from fricmodels.diagnosis.at_bounds import beyond_bounds
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.recording import Recording


def moved(fall: float, seed: int, *, viscous: float = 0.0) -> Recording:
    """Record twelve strokes in closed form, of a drive whose friction falls in proportion to its speed.

    Args:
        fall: of the friction [N m s/rad].
        seed: of the torque's noise.
        viscous: K_v [N m s/rad].
    """
    time = 0.01 * np.arange(2400)
    rate = 2 * np.pi * np.array([0.25, 0.11])
    size = np.array([2.0, 1.2])
    phase = np.outer(time, rate)
    position, velocity = np.sin(phase) @ size, np.cos(phase) @ (size * rate)
    acceleration = -np.sin(phase) @ (size * rate**2)
    friction = (0.25 - fall * np.abs(velocity)) * np.sign(velocity) + viscous * velocity
    noise = 0.01 * np.random.default_rng(seed).standard_normal(len(time))
    torque = 0.008 * acceleration + friction + noise
    channels = {"time": time, "torque": torque, "velocity": velocity, "position": position}
    return Recording("falling", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.long), 2])
def test_friction_that_falls_all_along_is_named(seed: int) -> None:
    """A negative K_v is all of it, in the rows that effects are tested on, and the fit may not have one."""
    found = diagnose(moved(0.05, seed), "coulomb-viscous")
    assert found.comparison.estimate.parameters["K_v"] == 0.0
    names = {name for finding in found.findings for name in finding.names}
    assert names & {"stribeck", "nonlinear-viscous"}, (found.verdict, found.findings)


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (0, 2, 3))])
def test_without_such_a_fall_nothing_is_kept(seed: int) -> None:
    """K_v is 0 at its bound by chance, or is not."""
    assert beyond_bounds(compare(moved(0.0, seed), "coulomb-viscous"), POLICY) is None
    assert beyond_bounds(compare(moved(0.0, seed, viscous=0.02), "coulomb-viscous"), POLICY) is None
    assert diagnose(moved(0.0, seed), "coulomb-viscous").verdict == "adequate"


def test_only_a_parameter_that_would_lie_beyond_its_bound_is_kept() -> None:
    within = beyond_bounds(compare(moved(0.05, 1), "coulomb-viscous"), POLICY)
    assert within is not None
    assert within.kept == {"K_v"}


def braked(seed: int, peak: float) -> Recording:
    """Record the same strokes of a drive with an eddy-current brake, whose torque is largest at a speed [rad/s]."""
    recording = moved(0.0, seed)
    ratio = recording.velocity / peak
    return recording.with_channels(torque=recording.torque + 0.4 * ratio / (1.0 + ratio**2))


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("peak", [1.2, 2.0])
def test_what_bounds_keep_from_a_fit_is_not_adequate(peak: float, seed: int) -> None:
    """Without the bounds a polynomial of the speed is that curve, and nothing was seen of an error of 9 %."""
    assert diagnose(braked(seed, peak), "coulomb-viscous+nonlinear-viscous", 0.008).verdict != "adequate"


@pytest.mark.parametrize("seed", [1, 2])
def test_what_ends_at_its_bound_for_that_of_another_is_kept(seed: int) -> None:
    """The coefficient of the root of the speed would be positive, if only K_v could be negative."""
    within = beyond_bounds(compare(braked(seed, 1.2), "coulomb-viscous+nonlinear-viscous", 0.008), POLICY)
    assert within is not None
    assert within.kept == {"K_v", "nonlinear-viscous.a"}
