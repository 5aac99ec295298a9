"""False time stamps: told from true ones, and even ones in their place."""

import numpy as np
import pytest
from tests.conftest import Made

import fricmodels
from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals.stamps import unevenness, with_even_stamps
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready

STEP = 0.002
COUNT = 6000
INERTIA, VISCOUS, COULOMB = 0.02, 0.05, 0.3


def drive(at: Array) -> dict[str, Array]:
    """Position, velocity and torque of a drive with Coulomb and viscous friction at given times."""
    phases = [(1.0, 2.1), (0.5, 5.3), (0.2, 11.0)]
    position = sum(a * np.sin(w * at) for a, w in phases)
    velocity = sum(a * w * np.cos(w * at) for a, w in phases)
    acceleration = sum(-a * w**2 * np.sin(w * at) for a, w in phases)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.sign(velocity)
    return {"position": position, "velocity": velocity, "torque": torque}


def recorded(taken: Array, stamps: Array, *channels: str, seed: int = 0) -> Recording:
    rng = np.random.default_rng(seed)
    values = drive(taken)
    noisy = {name: values[name] + 1e-5 * rng.standard_normal(len(taken)) for name in channels}
    return Recording(
        "shaken",
        Motion.ROTARY,
        {"time": stamps, "torque": values["torque"], **noisy},
        np.zeros(len(taken), dtype=np.int64),
    )


def shaken(share: float, seed: int = 0, count: int = COUNT) -> Array:
    return share * STEP * np.clip(np.random.default_rng(seed + 9).standard_normal(count), -2, 2)


@pytest.mark.parametrize("channel", ["position", "velocity"])
def test_even_stamps_take_the_place_of_false_ones(channel: str) -> None:
    time = STEP * np.arange(COUNT)
    found = with_even_stamps(recorded(time, time + shaken(0.15), channel)).time
    assert np.max(np.abs(found - time)) < 0.01 * STEP


def test_true_stamps_stay() -> None:
    time = STEP * np.arange(COUNT) + shaken(0.15)
    recording = recorded(time, time, "position")
    assert with_even_stamps(recording) is recording
    even = recorded(STEP * np.arange(COUNT), STEP * np.arange(COUNT), "position")
    assert with_even_stamps(even) is even


def test_what_is_true_of_the_stamps_stays() -> None:
    time, off = STEP * np.arange(COUNT), shaken(0.15)
    found = with_even_stamps(recorded(time + 0.25 * off, time + off, "position")).time
    assert np.std(found - time - 0.25 * off) < 0.01 * STEP


def test_lost_samples_stay_lost() -> None:
    kept = np.sort(np.random.default_rng(3).permutation(COUNT)[: COUNT - 200])
    time = STEP * np.arange(COUNT)[kept]
    found = with_even_stamps(recorded(time, time + shaken(0.15, count=len(kept)), "position")).time
    assert np.max(np.abs(found - time)) < 0.02 * STEP


def test_a_clock_that_drifts_is_followed() -> None:
    time = STEP * np.arange(COUNT)
    time = time + 3.0 * STEP * np.sin(0.9 * time)
    found = with_even_stamps(recorded(time, time + shaken(0.1), "position")).time
    assert np.std(found - time) < 0.03 * STEP


def test_false_stamps_no_longer_make_the_inertia_too_small() -> None:
    """A velocity over false intervals is too large by the mean square of their error, and the inertia too small."""
    time = STEP * np.arange(COUNT)
    recording = recorded(time, time + shaken(0.16), "position")
    model = fricmodels.Model.of("coulomb-viscous")
    found = estimate(fricmodels.Drive(model, None), ready(recording))[1]
    assert found.parameters["J"] == pytest.approx(INERTIA, rel=2e-3)
    assert found.parameters["K_v"] == pytest.approx(VISCOUS, rel=0.02)
    assert found.parameters["K_c"] == pytest.approx(COULOMB, rel=0.01)


def test_a_difference_over_false_intervals_is_known_by_them() -> None:
    time = STEP * np.arange(COUNT)
    stamps = time + shaken(0.15)
    values = recorded(time, stamps, "position")
    differenced = values.with_channels(derived=False, velocity=np.gradient(values["position"], stamps))
    both = ready(differenced)
    assert "velocity" in both.derived
    assert np.std(both.velocity - drive(time)["velocity"]) < 0.01 * np.std(both.velocity)


def test_intervals_of_any_length_are_jitter_and_lost_samples_are_none(made: Made) -> None:
    """A logger that writes when it can, and one that loses every twentieth sample."""
    whole = made(samples=2000)
    rng = np.random.default_rng(3)
    anywhere = whole.with_channels(time=np.cumsum(0.002 * rng.uniform(0.5, 4.0, len(whole))))
    assert unevenness(anywhere) > 0.4
    assert unevenness(whole.select(np.arange(len(whole)) % 20 != 7)) < 1e-6
