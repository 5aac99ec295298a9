"""Scores of known errors, their invariances, and the statistics of the information criteria."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.fit import Fit
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import (
    filtered_torque_error,
    information_criteria,
    last_cycles,
    score,
    sliding_half_width,
    torque_amplitude,
    torque_error,
)
from fricmodels.signals import prepare
from fricmodels.simulation import simulate
from fricmodels.weakform.prepared import ready

TRUE = {"K_v1": 1e-4, "K_v2": 6.6e-5, "K_c1": 1e-2, "K_c2": 6.6e-3}
J = 4.87e-6
OMEGA = 39.54


def drive() -> Drive:
    return Drive(Model.parse("asymmetric-coulomb-viscous"), J)


def recording(amplitude: float = 0.028, noise: float = 0.0, seed: int = 0, offset: float = 0.0) -> Recording:
    time = np.arange(2000) * np.pi / 100 / OMEGA
    return simulate(drive(), TRUE, time + offset, amplitude * np.sin(OMEGA * time), noise=noise, seed=seed)


def percent(error: np.ndarray, of: Recording) -> float:
    return 100 * float(np.sqrt(np.mean(error[last_cycles(of, 2)] ** 2))) / torque_amplitude(of)


def fit_of(values: dict[str, float]) -> Fit:
    return Fit("m", "e", "d", {"J": J, **values}, np.eye(4), tuple(values))


@pytest.mark.parametrize("amplitude", [0.011, 0.015, 0.02, 0.028])
def test_the_truth_leaves_next_to_nothing_over(amplitude: float) -> None:
    r = recording(amplitude)
    assert percent(filtered_torque_error(drive(), TRUE, r), r) < 0.15


def test_the_literal_error_of_the_truth_is_the_smear_at_reversals() -> None:
    r = recording()
    prepared = prepare(r)
    error = torque_error(drive(), TRUE, prepared)
    assert 1.0 < percent(error, r) < 4.0
    sign = np.sign(r.velocity)
    far = np.array([abs(sign[max(0, i - 3) : i + 4].sum()) == 7 for i in range(len(r))])
    assert np.sqrt(np.mean(error[far] ** 2)) < 0.002 * 0.028


@pytest.mark.parametrize(("noise", "paper"), [(5, 4.38), (10, 5.90), (20, 9.92)])
def test_noise_alone_leaves_less_than_the_paper(noise: float, paper: float) -> None:
    found = [
        percent(filtered_torque_error(drive(), TRUE, r), r) for r in (recording(noise=noise, seed=s) for s in range(5))
    ]
    assert np.median(found) < paper


def test_an_error_of_one_coefficient_is_found_at_its_size() -> None:
    r = recording()
    wrong = {**TRUE, "K_c1": TRUE["K_c1"] + 1e-3, "K_c2": TRUE["K_c2"] + 1e-3}
    error = filtered_torque_error(drive(), wrong, r)
    sliding = np.abs(r.velocity) > 20
    assert np.allclose(np.abs(error[sliding]), 1e-3, atol=3e-5)
    assert np.all(np.sign(error[sliding]) == -np.sign(r.velocity[sliding]))


def test_at_rest_only_what_lies_outside_the_sticking_interval_counts() -> None:
    time = np.linspace(0, 1, 1001)
    torque = 8e-3 * np.sin(2 * np.pi * time)
    at_rest = Recording(
        "rest",
        drive().motion,
        {"time": time, "torque": torque, "velocity": np.zeros(1001), "acceleration": np.zeros(1001)},
        np.zeros(1001, dtype=np.int64),
    )
    expected = np.where(torque < -6.6e-3, torque + 6.6e-3, 0.0)
    assert np.allclose(torque_error(drive(), TRUE, at_rest), expected, atol=1e-12)
    assert np.max(np.abs(filtered_torque_error(drive(), TRUE, at_rest, 1) - expected)) < 2e-5


def test_smoothing_does_not_turn_the_direction_of_a_creeping_drive() -> None:
    """It creeps at 0.01 rad/s and is then driven on: over 79 samples a parabola lies below zero before the bend."""
    rate, noise = 500.0, np.random.default_rng(0)
    time = np.arange(round(2 * rate)) / rate
    phase = np.clip(27.0 * (time - 1.0), 0.0, np.pi)
    velocity, acceleration = 0.01 + 1.3 * (1.0 - np.cos(phase)), 1.3 * 27.0 * np.sin(phase)
    torque = 0.35 * acceleration + 3.0 * velocity + 4.0
    channels = {"time": time, "torque": torque, "velocity": velocity + 0.001 * noise.standard_normal(len(time))}
    made = Recording("creeps", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    whole, values = Drive(Model.parse("coulomb-viscous"), 0.35), {"K_v": 3.0, "K_c": 4.0}
    error = filtered_torque_error(whole, values, made, 39)
    assert np.max(np.abs(error)) < 0.15, "of a friction of 4 N m; with its sign turned it is as much"


def test_percentages_do_not_depend_on_the_units_or_the_time_of_start() -> None:
    r = recording(noise=5)
    reference = score(drive(), fit_of(TRUE), prepare(r), measure="paper").rms_torque_error_percent
    shifted = recording(noise=5, offset=1000.0)
    assert score(drive(), fit_of(TRUE), prepare(shifted), measure="paper").rms_torque_error_percent == pytest.approx(
        reference, rel=1e-6
    )
    channels = {"time": r.time, "torque": 1e3 * r.torque, "velocity": r.velocity}
    stronger = dataclasses.replace(r, channels=channels)
    values = {key: 1e3 * value for key, value in TRUE.items()}
    big = Drive(Model.parse("asymmetric-coulomb-viscous"), 1e3 * J)
    fit = dataclasses.replace(fit_of(values), parameters={"J": 1e3 * J, **values})
    assert score(big, fit, prepare(stronger), measure="paper").rms_torque_error_percent == pytest.approx(
        reference, rel=1e-6
    )


def test_score_of_train_and_test() -> None:
    train, test = prepare(recording(noise=2, seed=1)), prepare(recording(noise=2, seed=2))
    good = score(drive(), fit_of(TRUE), train, test)
    bad = score(drive(), fit_of({**TRUE, "K_v1": 2e-4}), train, test)
    assert good.held_out_rms_torque_error < bad.held_out_rms_torque_error
    assert good.simulated_velocity_error_percent < 3.0 < bad.simulated_velocity_error_percent
    assert good.bic < bad.bic
    assert (good.samples, good.held_out_samples) == (2000, 2000)
    reference = 100 * good.rms_torque_error / np.sqrt(np.mean(train.torque**2))
    assert good.rms_torque_error_percent == pytest.approx(reference)
    alone = score(drive(), fit_of(TRUE), train, simulate=False)
    assert np.isnan(alone.held_out_rms_torque_error)
    assert np.isnan(alone.simulated_velocity_error)


def test_effective_samples_of_white_and_of_correlated_residuals() -> None:
    rng = np.random.default_rng(0)
    white = rng.standard_normal(20000)
    run = np.zeros(20000, dtype=np.int64)
    assert information_criteria(white, run, 3)[2] == pytest.approx(20000, rel=0.1)
    correlated = np.empty(20000)
    correlated[0] = 0
    for i in range(1, 20000):
        correlated[i] = 0.9 * correlated[i - 1] + white[i]
    assert information_criteria(correlated, run, 3)[2] == pytest.approx(20000 / 19, rel=0.3)


def test_half_width_grows_with_noise_and_is_one_without() -> None:
    widths = [sliding_half_width(recording(noise=noise)) for noise in (0, 1, 5, 20)]
    assert widths[0] == 1
    assert widths == sorted(widths)
    assert widths[-1] >= 12


@pytest.mark.parametrize("interval", [2e-3, 1e-3, 5e-4])
def test_widths_of_exact_positions_do_not_hang_on_their_last_digits(interval: float) -> None:
    """A width for the rounding of a position is 1, one for a change of its ninth digit 2 to 10."""
    time = interval * np.arange(8000)
    exact = 2.0 + 1.5 * np.sin(0.7 * time) + 0.4 * np.sin(2.9 * time + 1.0)
    widths = set()
    for change in (0.0, 1e-9):
        position = exact * (1.0 + change * np.random.default_rng(0).uniform(-1.0, 1.0, len(time)))
        channels = {"time": time, "torque": np.ones_like(time), "position": position}
        ready_one = ready(Recording("exact", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))
        widths.add((ready_one.derived_over, sliding_half_width(ready_one)))
    assert len(widths) == 1


def test_last_cycles() -> None:
    r = recording()
    assert np.array_equal(np.flatnonzero(last_cycles(r, 2)), np.arange(1600, 2000))
    assert torque_amplitude(r) == pytest.approx(0.028)
    with pytest.raises(InputError, match="cycles"):
        last_cycles(r.select(np.arange(150)), 2)


def test_even_and_uneven_time_stamps_are_averaged_alike():
    from fricmodels.score import torque

    rng = np.random.default_rng(0)
    time = 0.002 * np.arange(400)
    error = rng.standard_normal(399)
    jittered = time + np.where(np.arange(400) == 200, 3e-6, 0.0)
    even, uneven = (torque._window_means([error], stamps, 12)[0] for stamps in (time, jittered))
    assert even == pytest.approx(uneven, abs=1e-3)


def test_windows_of_uneven_time_stamps_have_the_weights_of_the_definition():
    from fricmodels.score import torque

    rng = np.random.default_rng(0)
    time, errors, width = np.cumsum(0.002 + 0.001 * rng.random(1300)), rng.standard_normal((2, 1299)), 12
    found = np.array(torque._window_means(list(errors), time, width))
    for sample in (width, 517, 1300 - width - 1):
        around = slice(sample - width, sample + width)
        steps, middle = np.diff(time)[around], 0.5 * (time[:-1] + time[1:])[around]
        weights = steps * np.maximum(((width + 0.5) * steps.mean()) ** 2 - (middle - time[sample]) ** 2, 0.0)
        np.testing.assert_allclose(found[:, sample], errors[:, around] @ weights / weights.sum(), rtol=1e-12)
    np.testing.assert_array_equal(found[:, 0], found[:, width])
