from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import savgol_filter

from fricmodels.dimension import Motion, Scales
from fricmodels.errors import InputError
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.signals import (
    Preparation,
    best_half_width,
    butterworth,
    central_difference,
    is_even,
    lanczos_derivative,
    lanczos_smooth,
    lanczos_window,
    noise,
    noise_of,
    prepare,
    quantum,
    resample,
    resting,
    standstill,
    stretches,
)
from fricmodels.signals.lanczos import DEGREE

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


def uneven(count, seed=0, duration=10.0):
    return np.sort(np.random.default_rng(seed).uniform(0.0, duration, count))


def recording(time, run=None, **channels):
    run = np.zeros(len(time), dtype=np.int64) if run is None else run
    return Recording("r", Motion.ROTARY, {"time": time, "torque": np.ones_like(time), **channels}, run)


# Derivative


def test_the_formula_of_lanczos():
    rng = np.random.default_rng(0)
    values, step, h = rng.standard_normal(60), 0.01, 4
    _, slope = lanczos_derivative(step * np.arange(60), values, h)
    k = np.arange(1, h + 1)
    expected = [
        3 * (k @ (values[i + k] - values[i - k])) / (h * (h + 1) * (2 * h + 1) * step) for i in range(h, 60 - h)
    ]
    np.testing.assert_allclose(slope[h:-h], expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("time", [np.linspace(0, 10, 501), uneven(501)], ids=["even", "uneven"])
def test_polynomials_are_exact_up_to_the_degree(time, degree):
    coefficients = np.arange(1.0, degree + 2)
    value, slope = np.polyval(coefficients, time), np.polyval(np.polyder(coefficients), time)
    smooth, derivative = lanczos_derivative(time, value, 6)
    np.testing.assert_allclose(smooth, value, rtol=1e-8)
    np.testing.assert_allclose(derivative, slope, rtol=1e-6)


@pytest.mark.parametrize("time", [np.linspace(0, 10, 2001), uneven(2001)], ids=["even", "uneven"])
def test_a_sine(time):
    _, slope = lanczos_derivative(time, np.sin(2 * time), 3)
    np.testing.assert_allclose(slope, 2 * np.cos(2 * time), atol=2e-3)


@pytest.mark.parametrize("half_width", [3, 20, 60])
def test_on_an_even_grid_it_is_the_filter_of_savitzky_and_golay(half_width):
    step = 1e-3
    values = 1e3 + np.cumsum(np.random.default_rng(0).standard_normal(1000))
    smooth, slope = lanczos_derivative(step * np.arange(1000), values, half_width)
    np.testing.assert_allclose(smooth, savgol_filter(values, 2 * half_width + 1, DEGREE), atol=1e-8)
    expected = savgol_filter(values, 2 * half_width + 1, DEGREE, deriv=1, delta=step)
    np.testing.assert_allclose(slope, expected, atol=1e-9 * np.max(np.abs(expected)))


def test_even_and_uneven_ways_agree():
    time = np.linspace(0, 10, 1001)
    values = np.sin(time) + 0.01 * np.random.default_rng(1).standard_normal(len(time))
    fast = lanczos_derivative(time, values, 7)
    nearly = time + 2e-5 * np.sin(np.arange(1001.0))
    assert is_even(time)
    assert not is_even(nearly)
    slow = lanczos_derivative(nearly, values, 7)
    np.testing.assert_allclose(fast[0], slow[0], atol=1e-4)
    np.testing.assert_allclose(fast[1], slow[1], atol=2e-3)


@settings(max_examples=25, deadline=None)
@given(st.floats(-1e4, 1e4), st.floats(1e-3, 1e3), st.floats(-1e3, 1e3), st.integers(0, 50))
def test_shift_of_time_and_units(shift, unit, offset, seed):
    time = uneven(120, seed)
    values = np.sin(time)
    smooth, slope = lanczos_derivative(time, values, 5)
    other_smooth, other_slope = lanczos_derivative(unit * (time + shift), 3.0 * values + offset, 5)
    spread = np.abs(slope).max()
    np.testing.assert_allclose(other_smooth, 3.0 * smooth + offset, atol=1e-6 * (1 + abs(offset)) + 1e-5)
    np.testing.assert_allclose(other_slope * unit, 3.0 * slope, atol=1e-3 * spread)


def test_nothing_is_smeared_over_runs_and_gaps():
    time = np.concatenate([np.linspace(0, 1, 101), np.linspace(5, 6, 101), np.linspace(0, 1, 101)])
    run = np.repeat([0, 0, 1], 101)
    values = np.concatenate([time[:101], 7.0 - time[101:202], 3.0 * time[202:]])
    assert [part.start for part in stretches(time, run)] == [0, 101, 202]
    for _, slope in [lanczos_derivative(time, values, 8, run), (0, central_difference(time, values, run))]:
        np.testing.assert_allclose(slope, np.repeat([1.0, -1.0, 3.0], 101), rtol=1e-9)


def test_a_few_lost_samples_are_bridged():
    time = np.delete(np.linspace(0, 10, 1001), np.random.default_rng(0).choice(np.arange(1, 1000), 50, replace=False))
    assert len(stretches(time)) == 1
    _, slope = lanczos_derivative(time, time**2, 5)
    np.testing.assert_allclose(slope, 2 * time, atol=1e-8)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
def test_short_stretches(count):
    time = np.arange(count) * 0.1
    smooth, slope = lanczos_derivative(time, 2.0 * time, 5)
    np.testing.assert_allclose(smooth, 2.0 * time, atol=1e-12)
    np.testing.assert_allclose(slope, 2.0 if count > 1 else 0.0)


# Noise and width


@pytest.mark.parametrize("time", [np.linspace(0, 10, 5001), uneven(5001)], ids=["even", "uneven"])
def test_noise_is_found_under_a_signal(time):
    values = 5 * np.sin(2 * time) + 0.02 * np.random.default_rng(0).standard_normal(len(time))
    assert noise(time, values) == pytest.approx(0.02, rel=0.05)
    assert noise(time, 5 * np.sin(2 * time)) < 1e-3


@pytest.mark.parametrize(("level", "jitter"), [(1e-4, 0.0), (1e-2, 0.0), (1e-3, 2e-4)])
def test_the_width_is_nearly_the_best(level, jitter):
    rng = np.random.default_rng(3)
    time = np.arange(5000) * 1e-3 + rng.uniform(-jitter, jitter, 5000)
    values = np.sin(6 * time) + level * rng.standard_normal(len(time))

    def error(half_width):
        return np.sqrt(np.mean((lanczos_derivative(time, values, half_width)[1] - 6 * np.cos(6 * time)) ** 2))

    least = min(error(h) for h in range(1, 130, 7))
    assert error(best_half_width(time, values)) < 1.25 * least


def test_no_signal_is_true_to_more_than_its_finest_steps():
    """Its last digits are no noise by which a width could be chosen."""
    time = 1e-3 * np.arange(4000)
    exact = 3.0 + 2.0 * np.sin(time)
    changed = exact * (1.0 + 1e-9 * np.random.default_rng(0).uniform(-1.0, 1.0, len(time)))
    found = [noise_of(time, values) for values in (exact, changed)]
    assert found[0].deviation == pytest.approx(found[1].deviation, rel=1e-6)
    assert found[0].deviation == pytest.approx(1e-8 * np.median(exact) / np.sqrt(12.0), rel=1e-6)
    assert best_half_width(time, exact, noise=found[0]) == best_half_width(time, changed, noise=found[1])


def test_the_width_does_not_depend_on_units():
    time = np.arange(3000) * 1e-3
    values = np.sin(9 * time) + 1e-3 * np.random.default_rng(3).standard_normal(len(time))
    width = best_half_width(time, values)
    assert width == best_half_width(60 * time + 5, 1e4 * values)


@settings(deadline=None)
@given(st.floats(1e-6, 1e3), st.integers(0, 1000))
def test_the_step_of_a_quantised_signal(step, seed):
    values = step * np.round(np.random.default_rng(seed).normal(0, 20, 500))
    assert quantum(values) == pytest.approx(step)
    assert quantum(values + 0.3 * step * np.random.default_rng(seed).random(500)) != pytest.approx(step, rel=1e-3)


def test_constants_and_two_levels_have_their_step():
    assert quantum(np.ones(5)) == 0.0
    assert quantum(np.array([0.0, 2.0, 0.0])) == 2.0


def test_a_step_is_found_where_the_last_digits_are_noise():
    rng = np.random.default_rng(0)
    values = 2e-5 * rng.integers(0, 200_000, 2_000)
    assert quantum(values * (1 + 1e-9 * rng.uniform(-1, 1, 2_000))) == pytest.approx(2e-5, rel=1e-2)


def test_a_drive_that_turns_hardly_ever_stands_still_and_one_that_stands_does():
    turning = np.sin(0.01 * np.arange(10_000) + 0.5)
    assert np.mean(np.abs(turning) <= standstill(turning)) < 1e-3
    stopping = np.maximum(turning, 0.0) + 1e-7 * np.random.default_rng(0).standard_normal(10_000)
    assert np.all(np.abs(stopping[turning < -0.1]) <= standstill(stopping))
    assert standstill(np.ones(1)) == 0.0


# Window and filter


def test_the_lanczos_window_is_symmetric_and_keeps_constants_and_slopes():
    window = lanczos_window(5)
    assert window.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(window, window[::-1])
    time = np.linspace(0, 1, 41)
    np.testing.assert_allclose(lanczos_smooth(time, 3.0 * time + 1.0, 5), 3.0 * time + 1.0)
    rough = np.random.default_rng(0).standard_normal(4000)
    weakened = lanczos_smooth(np.arange(4000.0), rough, 5).std()
    assert weakened == pytest.approx(np.linalg.norm(window), rel=0.05)


def test_the_butterworth_filter_has_no_phase_and_halves_power_at_the_cutoff_twice():
    time = np.arange(0, 4, 1e-3)
    values = np.sin(2 * np.pi * 20 * time)
    middle = slice(1000, 3000)
    np.testing.assert_allclose(butterworth(time, values, 100.0)[middle], values[middle], atol=1e-3)
    np.testing.assert_allclose(butterworth(time, values, 20.0)[middle], 0.5 * values[middle], atol=1e-3)


def test_the_butterworth_filter_says_what_it_cannot_do():
    with pytest.raises(InputError, match="even sampling"):
        butterworth(uneven(200), np.ones(200), 1.0)
    with pytest.raises(InputError, match="below half the sampling rate"):
        butterworth(np.arange(200.0), np.ones(200), 1.0)


# Preparation


def test_what_was_measured_stays():
    time = np.arange(0, 2, 1e-3)
    measured = recording(time, velocity=np.sin(9 * time))
    prepared = prepare(measured)
    assert prepared.derived == {"acceleration"}
    np.testing.assert_array_equal(prepared.velocity, measured.velocity)
    np.testing.assert_allclose(prepared["acceleration"], 9 * np.cos(9 * time), atol=0.02)
    assert prepare(prepared).checksum == prepared.checksum


@pytest.mark.parametrize(
    "preparation", [Preparation(), Preparation(method="butterworth"), Preparation(method="butterworth", decimate=10)]
)
def test_velocity_and_acceleration_from_position(preparation):
    time = np.arange(0, 4, 1e-3)
    position = np.sin(5 * time) + 1e-7 * np.random.default_rng(0).standard_normal(len(time))
    prepared = prepare(recording(time, position=position), preparation)
    assert prepared.derived == {"velocity", "acceleration"}
    inner = slice(5, -5)
    np.testing.assert_allclose(prepared.velocity[inner], 5 * np.cos(5 * prepared.time[inner]), atol=5e-3)
    np.testing.assert_allclose(prepared["acceleration"][inner], -25 * np.sin(5 * prepared.time[inner]), atol=0.25)


def test_preparation_in_other_units_is_the_same():
    time = np.arange(0, 2, 1e-3)
    values = np.sin(9 * time) + 1e-4 * np.random.default_rng(0).standard_normal(len(time))
    scales = Scales(force=3.0, displacement=0.1, time=7.0)
    measured = recording(time, position=values)
    one, other = prepare(measured).scaled(scales), prepare(measured.scaled(scales))
    for name in ("velocity", "acceleration"):
        np.testing.assert_allclose(one[name], other[name], rtol=1e-6, atol=1e-9 * np.abs(one[name]).max())


def test_preparation_refuses():
    time = np.arange(0, 2, 1e-3)
    with pytest.raises(InputError, match="neither velocity nor position"):
        prepare(recording(time))
    with pytest.raises(InputError, match="too short"):
        prepare(recording(time[:50], velocity=time[:50]), Preparation(decimate=20))
    with pytest.raises(ValueError, match="extra"):
        Preparation.model_validate({"cut_off": 3.0})


# Resampling


def test_resampling_gives_even_runs():
    time = np.concatenate([uneven(400, 1), uneven(300, 2)])
    run = np.repeat([3, 5], [400, 300])
    before = recording(time, run, velocity=2.0 * time)
    even = resample(before)
    np.testing.assert_allclose(even.velocity, 2.0 * even.time)
    for part in even.runs():
        np.testing.assert_allclose(np.diff(part.time), before.interval, rtol=1e-6)
    assert set(even.run.tolist()) == {3, 5}


# Rest


def stop_and_go(time, noise_level, seed=0):
    """Return position, velocity and truth of moves with rests between them."""
    phase = np.mod(time, 2.0)
    moving = phase < 1.2
    velocity = np.where(moving, np.sin(np.pi * phase / 1.2) * np.where(np.mod(time, 4.0) < 2.0, 1.0, -1.0), 0.0)
    position = np.cumsum(velocity) * (time[1] - time[0])
    rng = np.random.default_rng(seed)
    return position, velocity + noise_level * rng.standard_normal(len(time)), ~moving


@pytest.mark.parametrize("level", [0.0, 1e-3, 2e-2])
def test_rests_are_found(level):
    time = np.arange(0, 12, 2e-3)
    _, velocity, truth = stop_and_go(time, level)
    found = resting(recording(time, velocity=velocity))
    assert (found == truth).mean() > 0.95
    assert found[truth].mean() > 0.9


def test_rests_are_found_from_encoder_counts():
    time = np.arange(0, 12, 2e-3)
    position, _, truth = stop_and_go(time, 0.0)
    counts = 1e-3 * np.round(position / 1e-3)
    for prepared in (recording(time, position=counts), prepare(recording(time, position=counts))):
        found = resting(prepared)
        assert (found == truth).mean() > 0.93


@pytest.mark.parametrize("level", [0.0, 1e-3, 5e-2, 0.2])
def test_a_reversal_is_no_rest(level):
    time = np.arange(0, 20, 5e-3)
    velocity = np.sin(3 * time) + level * np.random.default_rng(1).standard_normal(len(time))
    assert resting(recording(time, velocity=velocity)).mean() < 0.01


def test_a_speed_sensor_that_hangs_on_one_step_is_at_rest_if_the_position_is():
    time = np.arange(0, 12, 2e-3)
    position, velocity, truth = stop_and_go(time, 0.0)
    coarse = 0.02 * np.round(velocity / 0.02) + np.where(truth, 0.02, 0.0)
    at_rest = recording(time, velocity=coarse, position=1e-3 * np.round(position / 1e-3))
    creeping = recording(time, velocity=coarse, position=1e-3 * np.round((position + 0.02 * time) / 1e-3))
    assert resting(at_rest)[truth].mean() > 0.9
    assert resting(creeping)[truth].mean() < 0.1


def test_rests_do_not_depend_on_units_and_direction():
    time = np.arange(0, 12, 2e-3)
    _, velocity, _ = stop_and_go(time, 1e-2)
    one = resting(recording(time, velocity=velocity))
    np.testing.assert_array_equal(one, resting(recording(60 * time + 7, velocity=-1e3 * velocity)))


# Real measurements


@pytest.mark.measured
@pytest.mark.skipif(not DATA.is_dir(), reason="the folder of real measurements is not beside the project")
@pytest.mark.parametrize("preparation", [Preparation(), Preparation(method="butterworth")])
def test_the_published_fit_of_emps(preparation):
    """The relative error and the parameters that its authors published, by their recipe and by Lanczos's derivative."""
    from scipy.signal import decimate

    axis = read(DATA / "emps/emps_id.csv", columns=["time=t", "force=force_N", "position=pos_m"])
    prepared = prepare(axis, preparation)
    ones = np.ones(len(prepared))
    regressors = [prepared["acceleration"], prepared.velocity, np.sign(prepared.velocity), ones]
    matrix = np.stack([decimate(column, 10) for column in regressors], axis=1)
    force = decimate(prepared.torque, 10)
    found = np.linalg.lstsq(matrix, force, rcond=None)[0]
    np.testing.assert_allclose(found, [95.1089, 203.5034, 20.3935, -3.1648], rtol=0.01)
    assert np.linalg.norm(force - matrix @ found) / np.linalg.norm(force) < 0.0409


@pytest.mark.long
def test_two_million_samples():
    time = np.arange(2_000_000) * 1e-3
    time += np.random.default_rng(0).uniform(-2e-4, 2e-4, len(time))
    prepared = prepare(recording(time, position=np.sin(time)))
    assert np.abs(prepared.velocity - np.cos(time)).max() < 1e-3


def test_stretches_are_all_samples():
    time = np.cumsum(np.random.default_rng(0).pareto(1.0, 500) + 0.1)
    parts = stretches(time)
    assert parts[0].start == 0
    assert parts[-1].stop == 500
    assert all(left.stop == right.start for left, right in pairwise(parts))


@pytest.mark.parametrize("count", [99, 100, 1000, 4097])
@pytest.mark.parametrize("width", [49, 51, 99])
def test_a_long_filter_by_transforms_of_blocks_is_the_direct_one(count: int, width: int) -> None:
    from fricmodels.signals.lanczos import _convolved

    rng = np.random.default_rng(count + width)
    values, weights = rng.standard_normal(count), rng.standard_normal(width)
    np.testing.assert_allclose(_convolved(values, weights), np.convolve(values, weights, "same"), atol=1e-12)
