"""The rows beneath a diagnosis: exact on a clean drive, blind at rest, the same in any units."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.directions import base_directions
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.smoothed import MAX_SAMPLES, spread

Made = Callable[..., Recording]
TRUTH = {"J": 2.0, "K_v": 0.5, "K_c": 3.0}
COULOMB_VISCOUS = Drive(Model.parse("coulomb-viscous"), 2.0)


def test_a_clean_drive_leaves_next_to_nothing_at_its_true_parameters(made: Made) -> None:
    """Reversals included: what causes a change of velocity within a sampling interval is weighted alike."""
    problem = WeakFormProblem.of(COULOMB_VISCOUS, made(noise=0.0), TRUTH)
    design, _ = problem.columns(COULOMB_VISCOUS)
    left = problem.target - np.array([0.5, 3.0]) @ design
    rms = float(np.sqrt(np.mean(problem.driving**2)))
    assert float(np.sqrt(np.mean(left**2))) < 4e-4 * rms
    assert float(np.max(np.abs(left))) < 4e-3 * rms


def test_the_finer_the_sampling_the_less_is_left(made: Made) -> None:
    sizes = []
    for rate in (250.0, 500.0, 1000.0):
        problem = WeakFormProblem.of(COULOMB_VISCOUS, made(noise=0.0, rate=rate, samples=int(16 * rate)), TRUTH)
        design, _ = problem.columns(COULOMB_VISCOUS)
        left = problem.target - np.array([0.5, 3.0]) @ design
        sizes.append(float(np.sqrt(np.mean(left**2) / np.mean(problem.driving**2))))
    assert sizes[0] > 1.5 * sizes[1] > 1.5**2 * sizes[2]


def test_the_rows_of_a_constant_acceleration_are_exact() -> None:
    """Constant acceleration: ∫φ dω is J times it, whatever the width, and viscous friction follows the mean speed."""
    time = np.arange(4000) * 1e-3
    channels = {"time": time, "torque": np.full(4000, 6.0), "velocity": 1.0 + 3.0 * time}
    recording = Recording("ramp", Motion.ROTARY, channels, np.zeros(4000, dtype=np.int64))
    problem = WeakFormProblem.of(COULOMB_VISCOUS, recording, {"J": 2.0, "K_v": 0.0, "K_c": 0.0})
    np.testing.assert_allclose(problem.driving[1:-1], 2.0 * problem.momentum[1:-1], rtol=1e-9)
    design, _ = problem.columns(COULOMB_VISCOUS)
    np.testing.assert_allclose(design[0] / design[1], recording.velocity[problem.centre], atol=3e-3)
    np.testing.assert_allclose(problem.sign_change, 0.0)


def test_rest_gives_no_rows(made: Made) -> None:
    moving = made(noise=0.0, samples=4000)
    still = np.zeros(4000)
    time = np.concatenate([moving.time, moving.time + 10.0])
    channels = {
        "time": time,
        "torque": np.concatenate([moving.torque, 2.9 * np.sin(time[4000:])]),
        "velocity": np.concatenate([moving.velocity, still]),
    }
    both = Recording("both", Motion.ROTARY, channels, np.repeat([0, 1], 4000))
    problem = WeakFormProblem.of(COULOMB_VISCOUS, both, TRUTH)
    assert np.all(problem.centre < 4000)
    _, found = estimate(COULOMB_VISCOUS, both)
    assert found.parameters["K_c"] == pytest.approx(3.0, rel=2e-3)


def test_runs_are_not_bridged(made: Made) -> None:
    one = made(noise=0.0, samples=4000)
    other = made(noise=0.0, samples=4000, seed=5)
    channels = {key: np.concatenate([values, other[key]]) for key, values in one.channels.items()}
    both = Recording("both", Motion.ROTARY, channels, np.repeat([0, 1], 4000))
    _, found = estimate(Drive(COULOMB_VISCOUS.model), both)
    for key, value in TRUTH.items():
        assert found.parameters[key] == pytest.approx(value, rel=2e-3)


def test_long_recordings_are_spread_over_blocks() -> None:
    count = MAX_SAMPLES * 2
    time = np.arange(count) * 1e-3
    channels = {"time": time, "torque": time, "velocity": np.sin(time)}
    recording = Recording("long", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))
    part = spread(recording)
    assert len(part) <= MAX_SAMPLES
    assert part.time[0] == 0.0
    assert part.time[-1] > 0.99 * time[-1]
    assert np.all(np.diff(part.time)[np.diff(part.run) == 0] == pytest.approx(1e-3))
    assert len(spread(recording.select(slice(0, 1000)))) == 1000


@pytest.mark.long
def test_the_blocks_of_a_long_recording_remember_what_was_before() -> None:
    """A bristle that was bent in a nudge stays bent while the drive stands; each block began with a straight one."""
    rate, drive = 20_000.0, Drive(Model.parse("coulomb-viscous+presliding"), 2.0)
    truth = {"J": 2.0, "K_v": 0.5, "K_c": 3.0, "presliding.F_1": 2.0, "presliding.F_2": 2.0, "presliding.D": 0.0}
    truth["presliding.x_s"] = 0.05
    time = np.arange(2 * MAX_SAMPLES) / rate
    part = np.where((time / 0.35) % 3.0 < 1.0, np.sign(np.sin(time / 1.7)), 0.0)
    nudge = 3.0 * part * np.sin(2.0 * np.pi * time / 0.7) ** 3
    position = np.concatenate([[0.0], np.cumsum(0.5 * (nudge[1:] + nudge[:-1])) / rate])
    channels = {"time": time, "velocity": nudge, "position": position, "torque": np.zeros(len(time))}
    exact = Recording("nudges", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    _, parameters = drive.timed(exact, truth)
    torque = 2.0 * np.gradient(nudge, 1.0 / rate) + drive.friction(exact, parameters)
    noisy = torque + 0.01 * np.random.default_rng(0).standard_normal(len(time))
    _, found = estimate(drive, exact.with_channels(derived=False, torque=noisy))
    for key in ("K_c", "presliding.F_1", "presliding.F_2", "presliding.x_s"):
        assert found.parameters[key] == pytest.approx(truth[key], rel=0.02), key


def test_wider_test_functions_where_the_velocity_is_noisier(made: Made) -> None:
    widths = [
        WeakFormProblem.of(COULOMB_VISCOUS, made(noise=noise), TRUTH).test_functions.width for noise in (0.05, 1.0, 5.0)
    ]
    assert widths == sorted(widths)
    assert widths[-1] > widths[0]


def test_base_directions_are_the_derivatives_of_the_models_torque(made: Made) -> None:
    drive = Drive(Model.parse("exponential-stick-slip"), 2.0)
    values = {"J": 2.0, "K_v": 0.5, "K_c": 6.0, "C": 3.0, "B": 1.0}
    problem = WeakFormProblem.of(drive, made(samples=4000), values)
    directions = base_directions(problem, values)
    assert directions.shape == (4, problem.rows)

    def rows(changed: dict[str, float]) -> np.ndarray:
        design, offset = problem.columns(drive, [changed["B"]])
        return np.array([changed["K_v"], changed["K_c"], changed["C"]]) @ design + offset

    for direction, key in zip(directions, ("K_v", "K_c", "C", "B"), strict=True):
        up, down = ({**values, key: values[key] + side * 1e-3} for side in (1, -1))
        slope = (rows(up) - rows(down)) / 2e-3
        np.testing.assert_allclose(direction, slope, atol=1e-5 * float(np.max(np.abs(slope))))


@pytest.mark.parametrize("apart", [0.0, 9e-16, -9e-16])
def test_a_parameter_whose_amplitude_is_at_its_bound_is_no_direction(made: Made, apart: float) -> None:
    """With C equal to K_c the speed B changes nothing: what it changes by a last digit is no direction."""
    drive = Drive(Model.parse("exponential-stick-slip"), 2.0)
    values = {"J": 2.0, "K_v": 0.5, "K_c": 3.1 + apart, "C": 3.1, "B": 1.0}
    problem = WeakFormProblem.of(drive, made(samples=4000), values)
    assert base_directions(problem, values).shape == (3, problem.rows)
    assert base_directions(problem, {**values, "K_c": 3.1 + 1e-6}).shape == (4, problem.rows)


@pytest.mark.parametrize(("samples", "noise", "width"), [(18, 0.0, 8), (18, 5.0, 24), (200, 0.0, 16)])
def test_short_strokes_have_narrow_rows_if_noise_allows(samples: int, noise: float, width: int) -> None:
    """A row of sixteen samples has room only in the middle of a stroke of eighteen."""
    time = np.arange(1000) / 200.0
    velocity = np.sin(np.pi * np.arange(1000) / samples)
    torque = np.sign(velocity) + 0.01 * np.gradient(velocity, time)
    velocity += 0.02 * noise * np.random.default_rng(0).standard_normal(1000)
    channels = {"time": time, "torque": torque, "velocity": velocity}
    recording = ready(Recording("strokes", Motion.ROTARY, channels, np.zeros(1000, dtype=np.int64)))
    drive = Drive(Model.parse("coulomb-viscous"), 0.01)
    values = {"K_v": 0.0, "K_c": 1.0, "J": 0.01}
    assert WeakFormProblem.of(drive, recording, values).test_functions.width == width
    assert WeakFormProblem.of(drive, recording, values, 16).test_functions.width == 16
