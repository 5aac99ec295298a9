"""Means of the residual in bins of a channel: found where something happens at one place, and nowhere else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.places import Place, largest_place, moderated, places, profile
from fricmodels.dimension import Motion
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


def zone(recording: Recording, height: float) -> tuple[Recording, float, float]:
    position = recording["position"]
    low, high = (float(q) for q in np.quantile(position, [0.35, 0.6]))
    more = height * np.sign(recording.velocity) * ((position > low) & (position < high))
    return recording.with_channels(derived=False, torque=recording.torque + more), low, high


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


def test_variances_that_differ_by_chance_are_one_variance() -> None:
    """With equal noise in every group the variance is that of all of them, and so are its degrees of freedom."""
    rng = np.random.default_rng(0)
    squares = rng.chisquare(5, 40) / 6
    variance, freedom = moderated(squares, np.full(40, 5))
    if np.ptp(variance) == 0.0:
        assert variance[0] == pytest.approx(np.sum(6 * squares) / 200)
        assert freedom[0] == 200
    assert np.ptp(variance) < 0.5


def test_variances_that_differ_keep_their_own() -> None:
    """Smyth's estimate of the prior, by its two moment equations, and the mean of prior and own it makes."""
    rng = np.random.default_rng(1)
    own = np.full(4000, 4)
    true = 2.0 * 8.0 / rng.chisquare(8.0, 4000)  # d_0 = 8, s_0² = 2
    shares = true * rng.chisquare(4, 4000) / 5
    variance, freedom = moderated(shares, own)
    assert freedom[0] - 4 == pytest.approx(8.0, rel=0.15)
    level = (variance * freedom - 5 * shares) / (freedom - 4)
    assert level[0] == pytest.approx(2.0, rel=0.05)


def test_false_places_are_as_rare_as_said_where_noise_goes_with_the_channel() -> None:
    """Few passes through bins of very different noise: the ratio of mean and error is Student's t."""
    from scipy.stats import t as student

    rng = np.random.default_rng(2)
    deviation = np.exp(0.8 * rng.standard_normal(20_000))
    values = deviation[:, None] * rng.standard_normal((20_000, 4))
    mean = values.mean(axis=1)
    variance, freedom = moderated(np.sum((values - mean[:, None]) ** 2, axis=1) / 4, np.full(20_000, 3))
    p_values = 2 * student.sf(np.abs(mean) / np.sqrt(variance / 4), freedom)
    for level in (0.05, 0.005):
        assert 0.6 * level < np.mean(p_values < level) < 1.5 * level


def test_a_zone_of_friction_is_found_along_the_motion(made: Made) -> None:
    """Its torque has the sign of the motion: in the mean over both directions it is nothing."""
    recording, low, high = zone(made(noise=0.5), 2.0)
    place = largest_place(examined(recording))
    assert place is not None
    assert (place.channel, place.direction) == ("position", "along the motion")
    width = high - low
    assert place.low == pytest.approx(low, abs=0.3 * width)
    assert place.high == pytest.approx(high, abs=0.3 * width)
    assert 1.0 < place.torque < 2.1


def test_a_bin_that_is_not_significant_by_itself_does_not_end_a_place(made: Made) -> None:
    recording, low, high = zone(made(noise=3.0, samples=12_000), 1.2)
    place = largest_place(examined(recording))
    assert place is not None
    assert place.high - place.low > 0.6 * (high - low)


def test_strokes_that_are_shorter_than_rows_have_no_places() -> None:
    """Every row has a reversal in it, so that no bin has any."""
    time = 0.01 * np.arange(460)
    phase = 2 * np.pi * 4.9 * time
    velocity = 0.09 * np.tanh(4.0 * np.sin(phase))
    torque = 800.0 * np.gradient(velocity, time) + 700.0 * np.sign(velocity)
    torque += 20.0 * np.random.default_rng(0).standard_normal(len(time))
    channels = {"time": time, "torque": torque, "velocity": velocity, "position": 0.01 * np.cumsum(velocity)}
    recording = Recording("short strokes", Motion.LINEAR, channels, np.zeros(len(time), dtype=np.int64))
    result = examined(recording)
    assert places(result.problem, result.regression, result.policy) == []
    assert diagnose(recording, "coulomb-viscous").verdict == "adequate"
