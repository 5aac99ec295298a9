"""The fit beneath every diagnosis: known truths, honest standard errors, invariances."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.weakform.estimate import estimate

Made = Callable[..., Recording]
TRUTH = {"J": 2.0, "K_v": 0.5, "K_c": 3.0}


def test_a_clean_recording_gives_the_truth(made: Made) -> None:
    _, found = estimate(Drive(Model.parse("coulomb-viscous")), made(noise=0.0))
    for key, value in TRUTH.items():
        assert found.parameters[key] == pytest.approx(value, rel=5e-4)


def test_a_given_inertia_is_kept_and_named_by_the_kind_of_drive(made: Made) -> None:
    _, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), made())
    assert found.parameters["J"] == 2.0
    assert set(found.standard_errors) == {"K_v", "K_c"}
    _, linear = estimate(Drive(Model.parse("coulomb-viscous"), motion=Motion.LINEAR), made(motion=Motion.LINEAR))
    assert linear.parameters["M"] == pytest.approx(2.0, rel=1e-2)


@pytest.mark.long
def test_standard_errors_cover_the_truth_about_as_often_as_said(made: Made) -> None:
    """Two standard errors should hold the truth in 95 % of recordings."""
    inside = dict.fromkeys(TRUTH, 0)
    trials = 40
    for seed in range(trials):
        _, found = estimate(Drive(Model.parse("coulomb-viscous")), made(noise=1.0, seed=seed, samples=3000))
        for key, value in TRUTH.items():
            inside[key] += abs(found.parameters[key] - value) < 2 * found.standard_errors[key]
    assert all(count / trials >= 0.8 for count in inside.values()), inside


def test_nonlinear_parameters_are_found_without_a_start(made: Made) -> None:
    hidden = {"stribeck.F_s": 3.0, "stribeck.omega_s": 1.0, "stribeck.delta": 1.0}
    recording = made("coulomb-viscous+stribeck", hidden, noise=0.0)
    _, found = estimate(Drive(Model.parse("exponential-stick-slip"), 2.0), recording)
    assert found.parameters["B"] == pytest.approx(1.0, rel=0.1)
    assert found.parameters["K_c"] == pytest.approx(6.0, rel=0.1)
    assert found.parameters["C"] == pytest.approx(3.0, rel=0.1)


@pytest.mark.parametrize("seed", [0, 2])
def test_a_friction_of_low_speed_is_not_extrapolated_from_higher_ones(made: Made, seed: int) -> None:
    """Where noise hides the direction no row is certain, and there this Stribeck friction acts: F_s was 0."""
    hidden = {"stribeck.F_s": 3.0, "stribeck.omega_s": 0.4, "stribeck.delta": 1.0}
    recording = made("coulomb-viscous+stribeck", hidden, noise=1.0, samples=3000, seed=seed)
    drive = Drive(Model.parse("coulomb-viscous+stribeck"), 2.0)
    _, found = estimate(drive, recording)
    truth = {**found.parameters, **TRUTH, **hidden}
    width = sliding_half_width(recording)
    left, least = (filtered_torque_error(drive, values, recording, width) for values in (found.parameters, truth))
    assert found.parameters["stribeck.F_s"] > 1.0
    assert left @ left < 1.05 * least @ least


def test_bounds_hold(made: Made) -> None:
    """A drive that is driven by its friction (negative viscosity) gets none, not less than none."""
    recording = made("coulomb-viscous", {"K_v": -0.5})
    _, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    assert found.parameters["K_v"] == 0.0


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_units_of_torque_do_not_matter(made: Made, factor: float) -> None:
    recording = made(samples=4000)
    _, one = estimate(Drive(Model.parse("coulomb-viscous")), recording)
    _, other = estimate(
        Drive(Model.parse("coulomb-viscous")), recording.with_channels(torque=factor * recording.torque)
    )
    for key in TRUTH:
        assert other.parameters[key] == pytest.approx(factor * one.parameters[key], rel=1e-6)
        assert other.standard_errors[key] == pytest.approx(factor * one.standard_errors[key], rel=1e-5)


def test_the_mirrored_drive_has_the_same_parameters(made: Made) -> None:
    recording = made(samples=4000)
    mirrored = recording.with_channels(velocity=-recording.velocity, torque=-recording.torque)
    _, one = estimate(Drive(Model.parse("coulomb-viscous")), recording)
    _, other = estimate(Drive(Model.parse("coulomb-viscous")), mirrored)
    for key in TRUTH:
        assert other.parameters[key] == pytest.approx(one.parameters[key], rel=1e-9)


def test_too_little_motion_is_refused(made: Made) -> None:
    with pytest.raises(InputError, match="moves too little"):
        estimate(Drive(Model.parse("asymmetric-exponential-stick-slip")), made(samples=60, noise=20.0))


@pytest.mark.parametrize("samples", [12, -12])
def test_a_delay_is_the_whole_shift_in_time(made: Made, samples: int) -> None:
    recording = made(noise=0.05)
    size = abs(samples)
    behind = ("velocity", "position") if samples > 0 else ("torque",)
    ahead = {name: values[:-size] if name in behind else values[size:] for name, values in recording.channels.items()}
    late = Recording("late", recording.motion, ahead, recording.run[size:])
    drive = Drive(Model.parse("coulomb-viscous+sensor-delay"))
    problem, found = estimate(drive, late)
    for key, value in TRUTH.items():
        assert found.parameters[key] == pytest.approx(value, rel=0.01)
    assert found.parameters["sensor-delay.T"] == pytest.approx(samples * late.interval, rel=0.01)
    assert problem.delay == pytest.approx(samples * late.interval, rel=0.01)
    assert found.standard_errors["sensor-delay.T"] < 0.1 * late.interval


def test_a_delay_is_not_known_where_the_torque_never_changes() -> None:
    """Four commands from rest, on stamps that wander: the rate of a torque that stands is nothing, and no rounding."""
    rng = np.random.default_rng(3)
    parts = []
    for command in (60.0, 80.0, -40.0, -100.0):
        time = np.cumsum(0.0063 + 0.0004 * rng.uniform(-1, 1, 150))
        final = (command - 6.2 * np.sign(command)) / 8.76
        velocity = final * (1.0 - np.exp(-time * 8.76 / 0.943))
        parts.append((time, np.full(150, command), velocity + 0.05 * rng.standard_normal(150)))
    time, torque, velocity = (np.concatenate(one) for one in zip(*parts, strict=True))
    run = np.repeat(np.arange(4), 150)
    recording = Recording("steps", Motion.ROTARY, {"time": time, "torque": torque, "velocity": velocity}, run)
    found = compare(recording, "coulomb-viscous+sensor-delay").estimate
    assert found.parameters["sensor-delay.T"] == 0.0
    assert "sensor-delay.T" in found.not_identified
    for key, value in {"J": 0.943, "K_v": 8.76, "K_c": 6.2}.items():
        assert found.parameters[key] == pytest.approx(value, rel=0.1)


def test_an_inertia_that_is_estimated_is_known_as_well_as_its_error_says(made: Made) -> None:
    _, found = estimate(Drive(Model.parse("coulomb-viscous"), None), made(noise=1.0))
    error = found.standard_errors["J"]
    assert 0 < error < 0.002 * 2.0
    assert abs(found.parameters["J"] - 2.0) < 5 * error
