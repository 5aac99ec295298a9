"""A Kalman filter takes positions as they are measured, not the velocity that was derived from them."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.ekf import ExtendedKalman
from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError, InputError
from fricmodels.estimator import Estimator
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.weakform.prepared import ready

INERTIA, VISCOUS, COULOMB, NOISE, STEP = 0.05, 0.12, 0.8, 2e-5, 1e-3
DRIVE = Drive(Model.parse("coulomb-viscous"), INERTIA)


def motion(torque: Array, *, held: bool, parts: int = 20) -> tuple[Array, Array]:
    """Return velocity and position of a drive from rest, with one's own fine steps and Karnopp's stick condition."""
    velocity = position = 0.0
    rows = []
    for i, now in enumerate(torque):
        rows.append((velocity, position))
        following = torque[min(i + 1, len(torque) - 1)]
        for j in range(parts):
            drives = now if held else now + (following - now) * (j + 0.5) / parts
            direction = np.sign(velocity) or np.sign(drives)
            if velocity == 0.0 and abs(drives) <= COULOMB:
                continue
            after = velocity + STEP / parts * (drives - VISCOUS * velocity - COULOMB * direction) / INERTIA
            after = 0.0 if after * direction < 0.0 else after
            position += 0.5 * STEP / parts * (velocity + after)
            velocity = after
    return np.array(rows).T[0], np.array(rows).T[1]


def record(seed: int, *, held: bool = True, runs: int = 1) -> Recording:
    """Return positions of an encoder and the torque, which jumps to its first value; runs begin at other places."""
    rng, time, parts = np.random.default_rng(seed), STEP * np.arange(4000), []
    for number in range(runs):
        phases = rng.uniform(0.0, 2.0 * np.pi, 4)
        torque = 4.0 * np.sign(np.cos(phases[0])) * np.exp(-time / 0.01)
        for k, phase in enumerate(phases):
            torque += 1.2 * np.sin(2.0 * np.pi * 0.5 * (k + 1) * time + phase)
        _, position = motion(torque, held=held)
        position += 10.0 * number + NOISE * rng.standard_normal(len(time))
        parts.append((time, torque, position))
    time, torque, position = map(np.concatenate, zip(*parts, strict=True))
    run = np.repeat(np.arange(runs), len(time) // runs)
    return ready(Recording("encoder", Motion.ROTARY, {"time": time, "torque": torque, "position": position}, run))


def filters() -> list[str]:
    """Return the Kalman filters that are installed."""
    return [name for name in ("ekf", "ukf") if name in load().estimators]


def estimator(name: str, **settings: object) -> Estimator:
    """Return a filter with settings."""
    found: Estimator = load().estimators[name](settings)
    return found


@pytest.mark.parametrize("name", filters())
@pytest.mark.parametrize("seed", range(4))
def test_positions_alone_give_the_parameters(name: str, seed: int) -> None:
    fit = estimator(name).fit(DRIVE, record(seed))
    assert fit.parameters["K_v"] == pytest.approx(VISCOUS, rel=0.01)
    assert fit.parameters["K_c"] == pytest.approx(COULOMB, rel=0.003)
    assert fit.provenance["noise"]["position"] == pytest.approx(NOISE, rel=0.1)


def test_the_derived_velocity_gives_them_worse() -> None:
    recordings = [record(seed) for seed in range(6)]
    derived, measured = (
        [ExtendedKalman({"measured": channel}).fit(DRIVE, one).parameters["K_v"] - VISCOUS for one in recordings]
        for channel in ("velocity", "position")
    )
    assert np.linalg.norm(measured) < np.linalg.norm(derived) / 3.0


def test_a_velocity_that_was_measured_is_what_is_filtered() -> None:
    recording = record(0)
    velocity, _ = motion(recording.torque, held=True)
    both = Recording("both", Motion.ROTARY, {**recording.channels, "velocity": velocity}, recording.run)
    fit = ExtendedKalman().fit(DRIVE, both)
    assert "velocity" in fit.provenance["noise"]
    assert fit.parameters["K_v"] == pytest.approx(VISCOUS, rel=0.01)


class Older(ExtendedKalman):
    """A filter that knows of velocities only, as one that was written before positions were filtered."""

    name = "older-filter"
    filters_positions = False


def test_a_filter_that_does_not_say_that_it_filters_positions_gets_velocities() -> None:
    recording = record(0)
    assert "velocity" in Older().fit(DRIVE, recording).provenance["noise"]
    with pytest.raises(EstimationError, match="'older-filter' does not filter positions"):
        Older({"measured": "position"}).fit(DRIVE, recording)


def test_a_filter_beside_a_drive_takes_velocities() -> None:
    with pytest.raises(InputError, match="takes velocities"):
        ExtendedKalman({"measured": "position"}).start(DRIVE, record(0))


@pytest.mark.parametrize("held", [False, True])
def test_whether_the_torque_is_held_is_told_by_the_likelihood(held: bool) -> None:
    for seed in range(3):
        recording = record(seed, held=held)
        problem = ExtendedKalman().problem(DRIVE, recording, by_position=True)
        assert problem.hold == ("held" if held else "linear")


def test_each_run_is_counted_from_where_it_begins() -> None:
    recording = record(1, runs=2)
    one, two = (ExtendedKalman({"engine": engine}).fit(DRIVE, recording) for engine in ("filterpy", "compiled"))
    assert two.parameters["K_v"] == pytest.approx(VISCOUS, rel=0.01)
    for key, value in one.parameters.items():
        assert two.parameters[key] == pytest.approx(value, rel=1e-6)


def test_a_state_and_a_place_are_carried_with_positions() -> None:
    """Presliding and gravity with one's own fine steps; the place is that of the encoder, the deflection a state."""
    rng, reach, weight, parts, count = np.random.default_rng(3), 0.02, 0.6, 40, 4000
    position = velocity = deflection = 0.0
    rows = []
    for i in range(count):
        torque = 2.0 * np.sin(2 * np.pi * 0.7 * i * 2e-3) + 0.8 * np.sin(2 * np.pi * 1.9 * i * 2e-3)
        rows.append((i * 2e-3, torque, position))
        for _ in range(parts):
            friction = 0.05 * velocity + 0.4 * deflection + weight * np.sin(position)
            velocity += 2e-3 / parts * (torque - friction) / 0.02
            deflection += 2e-3 / parts * (velocity - abs(velocity) * deflection) / reach
            position += 2e-3 / parts * velocity
    time, drives, place = np.array(rows).T
    channels = {"time": time, "torque": drives, "position": place + NOISE * rng.standard_normal(count)}
    made = ready(Recording("joint", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64)))
    fit = ExtendedKalman().fit(Drive(Model.parse("coulomb-viscous+gravity+presliding"), 0.02), made)
    assert fit.parameters["K_v"] == pytest.approx(0.05, rel=0.05)
    assert fit.parameters["K_c"] == pytest.approx(0.4, rel=0.05)
    assert fit.parameters["gravity.b"] == pytest.approx(weight, rel=0.02)
