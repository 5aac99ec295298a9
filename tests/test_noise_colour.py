"""The noise of a channel: how large, how long it lasts, told from motion; and what uses it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals import (
    Noise,
    best_half_width,
    lanczos_derivative,
    motion_noise,
    noise_of,
    resting,
    velocity_noise,
)
from fricmodels.signals import rest as rests_of
from fricmodels.signals.lanczos import even_weights

Array = NDArray[np.float64]
COUNT = 12_000
TIME = 0.001 * np.arange(COUNT)


def lasting(samples: float, seed: int = 0, count: int = COUNT) -> Array:
    factor = np.exp(-1.0 / samples)
    driving = np.random.default_rng(seed).standard_normal(count)
    driving[1:] *= np.sqrt(1 - factor**2)
    return np.asarray(lfilter([1.0], [1.0, -factor], driving))


def white(seed: int = 0) -> Array:
    return np.random.default_rng(seed).standard_normal(COUNT)


def moves() -> tuple[Array, Array]:
    """Velocity of moves with rests between, and where it rests."""
    phase = (TIME % 1.5) / 1.5
    side = np.where(TIME % 3.0 < 1.5, 1.0, -1.0)
    velocity = side * np.clip(np.minimum(phase, 0.7 - phase) / 0.15, 0.0, 1.0)
    return velocity, velocity == 0.0


def recorded(**channels: Array) -> Recording:
    return Recording(
        "r", Motion.ROTARY, {"time": TIME, "torque": white(9), **channels}, np.zeros(COUNT, dtype=np.int64)
    )


SINE = np.sin(2 * np.pi * 0.8 * TIME)


@pytest.mark.parametrize("signal", [SINE, np.abs(SINE), moves()[0]], ids=["sine", "kinks", "moves"])
def test_white_noise_is_white_and_of_its_size(signal: Array) -> None:
    found = noise_of(TIME, signal + 0.01 * white())
    assert found.lasting == 0.0
    assert found.deviation == pytest.approx(0.01, rel=0.05)


def test_motion_alone_is_no_noise() -> None:
    assert noise_of(TIME, SINE).deviation < 1e-6
    assert noise_of(TIME, np.abs(SINE)).deviation < 1e-5


@pytest.mark.parametrize("samples", [10.0, 50.0])
def test_noise_that_lasts_is_bounded_beside_motion(samples: float) -> None:
    """How fast it changes is known; how large it is in all, from above."""
    found = noise_of(TIME, SINE + 0.01 * lasting(samples))
    assert found.lasting**2 / found.samples == pytest.approx(0.01**2 / samples, rel=0.4)
    assert 0.008 < found.deviation < 0.04


@pytest.mark.parametrize("samples", [10.0, 50.0])
def test_a_drive_at_rest_tells_how_large_it_is_and_is_found_at_rest(samples: float) -> None:
    velocity, rest = moves()
    recording = recorded(velocity=velocity + 0.02 * lasting(samples))
    assert motion_noise(recording).deviation == pytest.approx(0.02, rel=0.25)
    found = resting(recording)
    assert np.mean(found & rest) > 0.95 * np.mean(rest)
    assert np.mean(found & ~rest) < 0.05


def test_the_position_tells_how_large_it_is() -> None:
    position = np.cumsum(SINE) * 0.001
    recording = recorded(velocity=SINE + 0.01 * lasting(50.0), position=2e-5 * np.round(position / 2e-5))
    assert velocity_noise(recording).deviation == pytest.approx(0.01, rel=0.25)


def test_a_slow_quantised_position_is_smoothed_as_widely_as_it_needs() -> None:
    """Its steps come every tens of samples: white noise of this size would ask for a tenth of the width."""
    position, step = -np.cos(2 * np.pi * 0.8 * TIME) / (2 * np.pi * 0.8), 0.02
    counted = step * np.floor(position / step)
    found = noise_of(TIME, counted)
    assert found.deviation == pytest.approx(step / np.sqrt(12))

    def error(half_width: int) -> float:
        return float(np.std(lanczos_derivative(TIME, counted, half_width)[1] - SINE))

    best = min(error(half_width) for half_width in (4, 8, 16, 32, 64, 96, 128))
    assert error(best_half_width(TIME, counted)) < 1.5 * best
    assert error(best_half_width(TIME, counted, noise=Noise(found.deviation))) > 4 * best


@pytest.mark.parametrize(
    "noise",
    [
        Noise(0.3),
        Noise(0.1, 0.2),
        Noise(0.1, 0.0, 0.4, 12.0),
        Noise(0.1, 0.0, 0.4, 12.0, filtered=even_weights(4)[1]),
        Noise(0.02 / np.sqrt(12), step=0.02, course=SINE, error=0.02 * np.floor(SINE / 0.02) + 0.01 - SINE),
    ],
    ids=["white", "difference", "lasting", "filtered", "staircase"],
)
def test_what_is_drawn_is_as_what_is_computed(noise: Noise) -> None:
    drawn = np.stack([noise.like(COUNT, np.random.default_rng(seed)) for seed in range(6)])
    assert np.std(drawn) == pytest.approx(noise.deviation, rel=0.05)
    covariance, near = (
        noise.covariance(40),
        0.06 if noise.course is None else 0.4,
    )  # a staircase is drawn with an offset
    for lag in (0, 1, 5, 30):
        measured = np.mean(drawn[:, lag:] * drawn[:, : COUNT - lag])
        assert measured == pytest.approx(covariance[lag], abs=near * covariance[0])
    for order in (0, 1):
        weights = even_weights(6)[order]
        behind = np.std([np.convolve(each, weights[::-1], "valid") for each in drawn])
        assert behind == pytest.approx(noise.after(weights), rel=2 * near)


def test_the_mirrored_signal_has_the_mirrored_noise() -> None:
    noise = Noise(0.02 / np.sqrt(12), step=0.02, course=SINE + 0.3)
    mirrored = Noise(0.02 / np.sqrt(12), step=0.02, course=-SINE - 0.3)
    there, back = (each.like(COUNT, np.random.default_rng(0)) for each in (noise, mirrored))
    np.testing.assert_array_equal(there, -back)


def test_false_stamps_make_noise_where_the_drive_accelerates() -> None:
    """Stamps off by a share of the interval change a velocity by as much of its change."""
    stamps = TIME + 0.0002 * np.random.default_rng(1).uniform(-1, 1, COUNT)
    acceleration = 2 * np.pi * 0.8 / np.sqrt(2)
    found = noise_of(stamps, SINE)
    assert found.deviation == pytest.approx(acceleration * 0.0002 / np.sqrt(3), rel=0.3)
    assert not found.lasting


def strokes(rate: float, noise: Array) -> tuple[Recording, NDArray[np.bool_]]:
    """Record a drive that goes to and fro in strokes of a tenth of a second, faster than their noise shows."""
    time = np.arange(len(noise)) / rate
    phase = (time % 0.5) / 0.5
    side = np.where(np.floor(time / 0.5) % 2 == 0, 1.0, -1.0)
    velocity = side * 5.0 * np.sin(np.pi * np.clip(phase / 0.4, 0.0, 1.0)) ** 2
    run = np.zeros(len(time), dtype=np.int64)
    channels = {"time": time, "torque": np.ones(len(time)), "velocity": velocity + noise}
    return Recording("strokes", Motion.ROTARY, channels, run), phase > 0.4


@pytest.mark.parametrize("lasts", [0.0, 20.0], ids=["white", "lasting"])
def test_rests_between_strokes_are_found_whose_motion_hides_the_noise(lasts: float) -> None:
    """Fourth differences of the strokes are larger than those of the noise: it is told where little happens."""
    draws = lasting(lasts, seed=3, count=1500) if lasts else np.random.default_rng(3).standard_normal(1500)
    recording, rests = strokes(125.0, 0.02 * draws)
    found = resting(recording)
    assert np.mean(found[rests]) > 0.85
    assert np.mean(found[~rests]) < 0.1
    assert velocity_noise(recording).deviation == pytest.approx(0.02, rel=0.4)


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_wider_bands_are_those_of_all_the_noise_that_shows(seed: int) -> None:
    """Hardly any of it is white here, and a few times that is no band in which this drive rests."""
    rng = np.random.default_rng(seed + 10)
    shown = 0.0012 * rng.standard_normal(3000) + 0.0035 * np.diff(rng.standard_normal(3001))
    recording, rests = strokes(250.0, 0.02 * lasting(9.0, seed=seed, count=3000) + shown)
    noise = Noise(0.0012, 0.0035)
    found = rests_of._in_wider_bands(recording, rests_of._seen(recording, noise))
    assert found.lasting == pytest.approx(0.02, rel=0.3)
    assert np.mean(rests_of._seen(recording, found).resting[rests]) > 0.95


def slow_motion(seed: int, noise: float) -> Recording:
    """Record an arm (0.05 kg m²) that never rests: five slow sines, which pass zero slowly once in a while."""
    rng, time = np.random.default_rng(seed), 0.001 * np.arange(8000)
    frequency, phase, size = rng.uniform(0.4, 11.0, 5), rng.uniform(0.0, 6.0, 5), rng.uniform(1.0, 3.0, 5)
    angle = np.outer(frequency, time) + phase[:, None]
    velocity, acceleration = size @ np.sin(angle), (size * frequency) @ np.cos(angle)
    torque = 0.05 * acceleration + 0.1 * velocity + 0.4 * np.sign(velocity) + 0.02 * rng.standard_normal(8000)
    channels = {"time": time, "torque": torque, "velocity": velocity + noise * rng.standard_normal(8000)}
    return Recording("arm", Motion.ROTARY, channels, np.zeros(8000, dtype=np.int64))


def test_a_slow_passage_through_zero_is_no_lasting_noise() -> None:
    """Once in a while a band about zero holds a passage as if it were a rest, and a wider one holds more of them."""
    for seed in range(20):
        recording = slow_motion(seed, 0.1)
        assert motion_noise(recording).deviation == pytest.approx(0.1, rel=0.05)
        assert np.mean(resting(recording)) < 0.02


def test_an_inertia_is_right_though_a_passage_seems_a_rest() -> None:
    for seed in (0, 3, 7):
        found = compare(slow_motion(seed, 0.01), "coulomb-viscous").estimate
        assert abs(found.parameters["J"] - 0.05) < 4 * found.standard_errors["J"]
        assert found.standard_errors["J"] < 0.002 * 0.05


def test_rests_are_the_same_in_other_units_and_the_other_direction() -> None:
    recording, _ = strokes(125.0, 0.02 * lasting(20.0, seed=5, count=1500))
    other = recording.with_channels(velocity=-57.3 * recording.velocity)
    np.testing.assert_array_equal(resting(other), resting(recording))


def test_noise_of_a_velocity_shows_beside_the_position() -> None:
    """The drive never rests nor goes steadily, and the encoder is finer than the velocity."""
    time = np.arange(3000) / 200.0
    moving = np.sin(2 * np.pi * 3.0 * time) + 0.7 * np.sin(2 * np.pi * 11.0 * time)
    position = np.cumsum(moving) / 200.0
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(time))
    run = np.zeros(len(time), dtype=np.int64)
    channels = {"time": time, "torque": moving, "velocity": moving + noise, "position": position}
    found = velocity_noise(Recording("both", Motion.ROTARY, channels, run))
    assert found.deviation == pytest.approx(0.05, rel=0.35)
