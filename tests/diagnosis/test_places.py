"""Means of the residual in bins of a channel: found where something happens at one place, and nowhere else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.places import Place, largest_place, profile
from fricmodels.recording import Recording

Made = Callable[..., Recording]


def examined(recording: Recording) -> CandidateTests:
    comparison = compare(recording, "coulomb-viscous", 2.0)
    return candidate_tests(replace(comparison.problem), comparison.estimate.parameters, only=["torque-offset"])


def bumpy(recording: Recording, height: float, *, forward_only: bool = False) -> tuple[Recording, float, float]:
    position = recording["position"]
    middle, width = float(np.quantile(position, 0.4)), 0.03 * float(np.ptp(position))
    bump = height * np.exp(-0.5 * ((position - middle) / width) ** 2)
    if forward_only:
        bump = np.where(recording.velocity > 0, bump, 0.0)
    return recording.with_channels(derived=False, torque=recording.torque + bump), middle, width


@pytest.mark.parametrize("seed", range(4))
def test_a_clean_drive_has_no_place_of_any_size(made: Made, seed: int) -> None:
    assert largest_place(examined(made(seed=seed, noise=1.0))) is None


def test_a_bump_is_found_where_it_is(made: Made) -> None:
    recording, middle, width = bumpy(made(noise=0.5), 2.0)
    place = largest_place(examined(recording))
    assert isinstance(place, Place)
    assert (place.channel, place.direction) == ("position", "both")
    assert place.low - width < middle < place.high + width
    assert place.high - place.low < 8 * width
    assert 0.6 < place.torque < 2.1
    assert place.p_value < 0.01


def test_a_bump_of_one_direction_is_found_there(made: Made) -> None:
    recording, _, _ = bumpy(made(noise=0.5, samples=16_000), 2.0, forward_only=True)
    place = largest_place(examined(recording))
    assert place is not None
    assert (place.channel, place.direction) == ("position", "forward")


def test_the_profile_has_the_bump(made: Made) -> None:
    recording, middle, width = bumpy(made(noise=0.5), 2.0)
    seen = profile(examined(recording), "position")
    assert seen is not None
    highest = int(np.argmax(seen.torque))
    assert abs(seen.at[highest] - middle) < 2 * width
    assert seen.torque[highest] > 5 * seen.error[highest]
    assert profile(examined(recording), "load_torque") is None


def test_units_change_nothing_but_units(made: Made) -> None:
    """A torque in another unit, with the inertia in its own, gives the same place with the torque in that unit."""
    recording, _, _ = bumpy(made(noise=0.5), 2.0)
    one = largest_place(examined(recording))
    scaled = recording.with_channels(derived=False, torque=1000 * recording.torque)
    comparison = compare(scaled, "coulomb-viscous", 2000.0)
    result = candidate_tests(replace(comparison.problem), comparison.estimate.parameters, only=["torque-offset"])
    other = largest_place(result)
    assert one is not None
    assert other is not None
    assert (other.low, other.high) == (pytest.approx(one.low), pytest.approx(one.high))
    assert other.torque == pytest.approx(1000 * one.torque, rel=1e-3)
