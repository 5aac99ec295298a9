"""The torque error per sample and over windows: exact balances, known missing torques, noise, and what is left out."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import headline_window, torque_error, torque_error_over, torque_errors, windows
from fricmodels.score.bands import CLEAR, noise_floors
from fricmodels.score.noise import apparent_inertia
from fricmodels.signals import prepare

ROOT = Path(__file__).parents[1]
J, COULOMB = 2.0, 3.0
COUNT, STEP = 2000, 1e-3
DRIVE = Drive(Model.of("coulomb-viscous"), J)
TRUE = {"J": J, "K_c": COULOMB, "K_v": 0.0}
SOURCES = ("velocity", "position", "acceleration")


def turning(torque: float, start: float, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return torque, velocity and position under a constant torque that turns the drive round once."""
    before, after = (torque - np.sign(start) * COULOMB) / J, (torque + np.sign(start) * COULOMB) / J
    turn = -start / before
    velocity = np.where(time < turn, start + before * time, after * (time - turn))
    position = np.where(
        time < turn, start * time + before * time**2 / 2, -(start**2) / before / 2 + after * (time - turn) ** 2 / 2
    )
    return np.full(len(time), torque), velocity, position


def turned(time: np.ndarray | None = None) -> Recording:
    """Return four runs with one reversal each, at no sample."""
    time = STEP * np.arange(COUNT) if time is None else time
    runs = [turning(side * size, -side * speed, time) for side, size, speed in
            ((1, 8.0, 4.1234), (-1, 7.0, 3.3), (1, 9.5, 5.017), (-1, 11.0, 6.01))]  # fmt: skip
    torque, velocity, position = (np.concatenate(parts) for parts in zip(*runs, strict=True))
    channels = {"time": np.tile(time, 4), "torque": torque, "velocity": velocity, "position": position}
    return Recording("turned", Motion.ROTARY, channels, np.repeat(np.arange(4), len(time)))


def sliding(source: str, time: np.ndarray | None = None) -> Recording:
    """Return a drive that only slides forward, its motion known by one channel; torques are straight lines."""
    time = STEP * np.arange(8 * COUNT) if time is None else time
    omega = 2 * np.pi
    velocity, rate = 5.0 + np.sin(omega * time), omega * np.cos(omega * time)
    position = 5.0 * time - np.cos(omega * time) / omega
    moved = {"velocity": velocity, "position": position, "acceleration": rate}
    known = {"velocity": velocity, source: moved[source]} if source != "position" else {"position": position}
    channels = {"time": time, "torque": J * rate + COULOMB, **known}
    return Recording(source, Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_the_true_model_leaves_nothing_at_a_reversal() -> None:
    recording = turned()
    recording = recording.select(slice(None)).with_channels(derived=False)
    prepared = prepare(
        dataclasses.replace(recording, channels={k: v for k, v in recording.channels.items() if k != "position"})
    )
    for window in windows(prepared):
        assert np.max(np.abs(torque_error_over(DRIVE, TRUE, prepared, window))) < 1e-8
    # Taken at its word, with a differentiator, eq. 21 leaves a third of the Coulomb torque beside each reversal.
    assert np.max(np.abs(torque_error(DRIVE, TRUE, prepared))) > COULOMB / 3


@pytest.mark.parametrize(("noise", "seed"), [(1.2e-4, 3), (2e-4, 0), (4e-4, 3)])
def test_the_true_model_leaves_noise_where_a_drive_stops_between_two_samples(noise: float, seed: int) -> None:
    """Smoothing swings over the bend; the sample after it is noise about zero, and no motion the other way."""
    rng, step, strokes = np.random.default_rng(seed), 4e-3, 24
    time = step * np.arange(600 * strokes)
    stroke = np.arange(600 * strokes) // 600
    since = time - step * 600 * stroke - rng.uniform(0.2, 0.2 + step, strokes)[stroke]
    side = np.where(stroke % 2, -1.0, 1.0)
    slope = side * np.select([since < 0, since < 0.7, since < 1.3, since < 2.0], [0.0, 1.0, 0.0, -1.0], 0.0)
    velocity = side * np.interp(since, [0.0, 0.7, 1.3, 2.0], [0.0, 0.7, 0.7, 0.0])
    # A stop is no jump of the torque: what braked the drive holds it.
    torque = np.where(since < 0.0, COULOMB * side, np.where(since < 2.0, J * slope + COULOMB * side, side))
    channels = {"time": time, "torque": torque, "velocity": velocity + noise * rng.standard_normal(len(time))}
    prepared = prepare(Recording("stops", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))
    error = torque_error_over(DRIVE, TRUE, prepared, 0.0)
    stops = (since > 1.9) & (since < 2.2)
    assert np.max(np.abs(error[stops])) < COULOMB / 2


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("jitter", [0.0, 0.6])
def test_a_missing_constant_torque_is_found_at_its_size_in_every_band(source: str, jitter: float) -> None:
    rng = np.random.default_rng(1)
    time = STEP * (np.arange(8 * COUNT) + jitter * rng.uniform(-0.5, 0.5, 8 * COUNT))
    time = np.delete(time, slice(5000, 5200))
    recording = sliding(source, time)
    prepared = prepare(recording.with_channels(derived=False, torque=recording.torque + 0.7))
    assert len(windows(prepared)) == 4
    for window in windows(prepared):
        error = torque_error_over(DRIVE, TRUE, prepared, window)
        smeared = 0.002 if source == "acceleration" else 0.02 if jitter else 2e-4
        assert np.max(np.abs(error[50:-50] - 0.7)) < smeared


@pytest.mark.parametrize(
    ("jitter", "source"),
    [
        (0.0, "velocity"),
        (0.0, "position"),
        pytest.param(0.0, "acceleration", marks=pytest.mark.long),
        pytest.param(0.6, "velocity", marks=pytest.mark.long),
        pytest.param(0.6, "position", marks=pytest.mark.long),
        (0.6, "acceleration"),
    ],
)
def test_white_noise_leaves_what_is_printed(source: str, jitter: float) -> None:
    rng = np.random.default_rng(2)
    time = STEP * (np.arange(20 * COUNT) + jitter * rng.uniform(-0.5, 0.5, 20 * COUNT))
    recording = sliding(source, time)
    size = {"velocity": 0.01, "position": 1e-5, "acceleration": 0.5}[source]
    noisy = recording[source] + size * rng.standard_normal(len(recording))
    torque = recording.torque + 0.2 * rng.standard_normal(len(recording))
    prepared = prepare(recording.with_channels(derived=False, torque=torque, **{source: noisy}))
    errors, _ = torque_errors(DRIVE, TRUE, prepared)
    for band in errors.bands[:3]:
        assert band.percent == pytest.approx(band.noise_floor_percent, rel=0.1)
    assert errors.bands[3].percent == pytest.approx(errors.bands[3].noise_floor_percent, rel=0.25)


@pytest.mark.parametrize("moving", [0.2, 0.8])
def test_counts_that_stand_still_say_nothing_of_noise(moving: float) -> None:
    """A drive that rests most of the time had no noise at all, and an error of 207 % for the steps of its encoder."""
    time, step = np.arange(8000) * STEP, 2 * np.pi / 65536
    away = np.clip(np.mod(time, 1.0) / moving, 0.0, 1.0)
    path = 0.4 * np.where(np.floor(time) % 2 == 0, 1.0, -1.0) * (0.5 - 0.5 * np.cos(2 * np.pi * away))
    counts = np.round(path / step) * step
    channels = {"time": time, "torque": np.ones(8000), "position": counts}
    recording = Recording("counts", Motion.ROTARY, channels, np.zeros(8000, dtype=np.int64))
    _, motion = noise_floors(prepare(recording))[0.0]
    moved = np.mod(time, 1.0)[1:-1] < moving
    rounding = np.sqrt(np.mean(np.diff(counts - path, 2)[moved] ** 2)) / STEP**2
    assert 0.5 * rounding < motion < 1.5 * rounding


@pytest.mark.parametrize(("source", "response"), [("velocity", 0.9549), ("position", 0.9120)])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.25])
def test_a_ripple_up_to_a_quarter_of_the_rate_enters_by_nine_tenths(source: str, response: float, share: float) -> None:
    recording = sliding(source)
    time, omega = recording.time, 2 * np.pi * share / STEP
    moved = {"velocity": -np.cos(omega * time) / omega, "position": -np.sin(omega * time) / omega**2}[source]
    shaken = prepare(recording.with_channels(derived=False, **{source: recording[source] + moved / J}))
    own = rms(torque_error_over(DRIVE, TRUE, shaken, 0.0)[9:-9]) * np.sqrt(2)
    assert own >= 0.9
    if share == 0.25:
        assert own == pytest.approx(response, abs=2e-3)
    in_torque = prepare(recording.with_channels(derived=False, torque=recording.torque + np.sin(omega * time + 0.3)))
    assert rms(torque_error_over(DRIVE, TRUE, in_torque, 0.0)) * np.sqrt(2) == pytest.approx(1.0, abs=2e-3)
    for window in (0.005, 0.02):
        expected = np.sinc(share / STEP * window) ** 2
        found = rms(torque_error_over(DRIVE, TRUE, shaken, window)[99:-99]) * np.sqrt(2)
        assert found == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize("source", ["velocity", "position"])
def test_a_fast_motion_that_the_model_explains_leaves_next_to_nothing(source: str) -> None:
    recording = sliding(source)
    time, omega = recording.time, 2 * np.pi * 20.0
    moved = {"velocity": -np.cos(omega * time) / omega, "position": -np.sin(omega * time) / omega**2}[source]
    torque = recording.torque + np.sin(omega * time)
    shaken = prepare(recording.with_channels(derived=False, torque=torque, **{source: recording[source] + moved / J}))
    # A straight line between samples differs from the sine by (2πf Δt)²/12 of it in the mean.
    assert np.max(np.abs(torque_error_over(DRIVE, TRUE, shaken, 0.005)[99:-99])) < 1.1 * (omega * STEP) ** 2 / 12


def test_figures_do_not_depend_on_units_direction_or_time_of_start() -> None:
    rng = np.random.default_rng(3)
    recording = turned()
    noisy = {name: values + size * rng.standard_normal(len(values)) for (name, values), size in
             zip(recording.channels.items(), (0, 0.1, 0.01, 0), strict=True) if name != "position"}  # fmt: skip

    def figures(factor: float, torque: float, start: float, inertia: float, values: dict[str, float]) -> list[float]:
        channels = {
            "time": noisy["time"] + start,
            "torque": torque * noisy["torque"],
            "velocity": factor * noisy["velocity"],
        }
        prepared = prepare(dataclasses.replace(recording, channels=channels))
        errors, _ = torque_errors(Drive(DRIVE.model, inertia), values, prepared, prepared)
        return [figure for band in errors.bands for figure in (band.percent, band.held_out_percent)]

    wrong = {**TRUE, "K_v": 0.3}
    expected = figures(1.0, 1.0, 0.0, J, wrong)
    assert figures(-1.0, -1.0, 0.0, J, wrong) == pytest.approx(expected, rel=1e-9)
    assert figures(1.0, 1.0, 500.0, J, wrong) == pytest.approx(expected, rel=1e-6)
    heavy = {key: 1000 * value for key, value in wrong.items()}
    assert figures(1.0, 1000.0, 0.0, 1000 * J, heavy) == pytest.approx(expected, rel=1e-9)
    in_turns = {"J": 2 * np.pi * J, "K_c": COULOMB, "K_v": 2 * np.pi * 0.3}
    assert figures(1 / (2 * np.pi), 1.0, 0.0, 2 * np.pi * J, in_turns) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("rate", "seconds", "expected", "headline"),
    [
        (10.0, 60.0, (0.0,), 0.0),
        (60.0, 60.0, (0.0, 0.02, 0.1), 0.0),
        (20_000.0, 1.0, (0.0, 0.005, 0.02, 0.1), 0.0),
        (1000.0, 0.15, (0.0, 0.005, 0.02), 0.0),
        (1000.0, 0.03, (0.0, 0.005), 0.0),
    ],
)
def test_windows_follow_the_rate_and_the_stretches(
    rate: float, seconds: float, expected: tuple[float, ...], headline: float
) -> None:
    time = np.arange(int(rate * seconds)) / rate
    recording = sliding("velocity", time)
    assert windows(recording) == expected
    assert headline_window(recording) == headline
    errors, error = torque_errors(Drive(Model.of("coulomb-viscous")), {**TRUE, "K_c": 0.0}, prepare(recording))
    assert errors.headline.window_ms == pytest.approx(1000 * (headline or 1 / rate))
    assert rms(error) == pytest.approx(COULOMB, rel=2e-2)
    assert rms(error) == errors.headline.SI
    assert np.isnan(errors.held_out_percent)


def noisy(size: float) -> Recording:
    recording = sliding("velocity")
    noise = size * np.random.default_rng(4).standard_normal(len(recording))
    return prepare(recording.with_channels(derived=False, velocity=recording.velocity + noise))


@pytest.mark.parametrize(("size", "window"), [(1e-5, 0.0), (0.002, 0.005), (0.01, 0.02), (0.1, 0.1), (30.0, 0.1)])
def test_the_headline_is_the_narrowest_window_that_noise_leaves_clear(size: float, window: float) -> None:
    prepared = noisy(size)
    assert headline_window(prepared) == headline_window(prepared, J) == window
    drives = [(name, given) for name in ("coulomb-viscous", "coulomb-viscous+torque-offset") for given in (J, None)]
    figures = [
        torque_errors(Drive(Model.of(name), given), {**TRUE, "J": J, "torque-offset.tau_0": 1.0}, prepared)[0]
        for name, given in drives
    ]
    assert all(each.headline.window_ms == pytest.approx(1000 * (window or STEP)) for each in figures)


def test_with_a_given_inertia_the_headline_keeps_its_rule() -> None:
    """A friction that goes with the acceleration hides two thirds of the inertia; the window named was too narrow."""
    found = noisy(0.002)
    hidden = found.with_channels(derived=False, torque=found.torque - 2 / 3 * J * found["acceleration"])
    assert apparent_inertia(hidden) == pytest.approx(J / 3, rel=0.1)
    line = torque_errors(DRIVE, TRUE, hidden)[0].headline
    assert line.window_ms == pytest.approx(1000 * headline_window(hidden, J))
    assert headline_window(hidden) < headline_window(hidden, J)
    assert line.noise_floor_percent <= 100 * CLEAR


def test_a_window_of_one_sample_stands_there_once() -> None:
    """At 200 Hz the interval is 4.9999… ms by the stamps."""
    time = 0.00499999999999 * np.arange(2000)
    assert windows(sliding("velocity", time)) == (0.0, 0.02, 0.1)


@pytest.mark.parametrize("share", [0.021, 0.1, 0.25])
def test_the_headline_shows_a_ripple_whole_and_its_noise_does_not_contain_it(share: float) -> None:
    """A ripple of half of the torque, up to a quarter of the sampling rate, with which the noise stays as it was."""
    recording, omega = sliding("velocity"), 2 * np.pi * share / STEP
    rng = np.random.default_rng(5)
    velocity = recording.velocity + 5e-5 * rng.standard_normal(len(recording))
    quiet = prepare(recording.with_channels(derived=False, velocity=velocity))
    moved = velocity - 5.0 * np.cos(omega * recording.time) / omega / J
    shaken = prepare(recording.with_channels(derived=False, velocity=moved))
    before, after = (torque_errors(DRIVE, TRUE, each)[0].headline for each in (quiet, shaken))
    assert np.sqrt(2 * (after.SI**2 - before.SI**2)) >= 0.9 * 5.0
    assert after.noise_floor_percent == pytest.approx(before.noise_floor_percent, rel=0.1)
    assert after.window_ms == before.window_ms == pytest.approx(1.0)


def test_no_window_reaches_over_a_gap_or_into_another_run() -> None:
    recording = sliding("velocity")
    time = recording.time + np.where(np.arange(len(recording)) >= 6000, 1.0, 0.0)
    run = (np.arange(len(recording)) >= 12_000).astype(np.int64)
    offset = np.where((np.arange(len(recording)) >= 6000) & (run == 0), 1.0, 0.0)
    channels = {**recording.channels, "time": time, "torque": recording.torque + offset}
    prepared = prepare(dataclasses.replace(recording, channels=channels, run=run))
    for window in windows(prepared):
        assert np.max(np.abs(torque_error_over(DRIVE, TRUE, prepared, window) - offset)) < 2e-3


def test_at_rest_only_what_lies_outside_the_sticking_interval_counts() -> None:
    time = STEP * np.arange(COUNT)
    torque = 5.0 * np.sin(2 * np.pi * time)
    channels = {"time": time, "torque": torque, "velocity": np.zeros(COUNT)}
    prepared = prepare(Recording("rest", Motion.ROTARY, channels, np.zeros(COUNT, dtype=np.int64)))
    beyond = np.sign(torque) * np.maximum(np.abs(torque) - COULOMB, 0.0)
    assert torque_error_over(DRIVE, TRUE, prepared, 0.0) == pytest.approx(beyond, abs=1e-9)
    inside = np.abs(torque) < 0.8 * COULOMB
    assert torque_error_over(DRIVE, TRUE, prepared, 0.02)[inside] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("sensors", ["velocity", "positions"])
def test_a_ripple_on_the_rig_enters_the_fitted_error_by_nine_tenths(
    sensors: str, from_benchmarks: Callable[[str], ModuleType]
) -> None:
    benchmark = from_benchmarks("torque_error")
    without = benchmark.errors(benchmark.recording(sensors, samples=6000))
    for way in ("motion", "torque"):
        for frequency in (12.0, 250.0):
            assert benchmark.shares(sensors, way, frequency, without, samples=6000)[0] >= 0.9


@pytest.mark.parametrize("creeping", [1.0, 2.0])
def test_where_the_direction_is_not_known_neither_is_taken(creeping: float) -> None:
    """A drive creeps as fast as its noise, pushed harder than a law that is a twentieth too small allows.

    With the friction of the direction that noise gives it would leave twice the friction there.
    """
    rng, time = np.random.default_rng(0), 0.002 * np.arange(10_000)
    slow = np.mod(time, 4.0) >= 2.0
    velocity = np.where(slow, creeping * 0.01, 1.0) * np.sin(np.pi * time)
    torque = J * np.gradient(velocity, time) + COULOMB * np.sign(velocity)
    channels = {"time": time, "velocity": velocity + 0.01 * rng.standard_normal(len(time)), "torque": torque}
    prepared = prepare(Recording("creeping", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))
    error = torque_error_over(DRIVE, {**TRUE, "K_c": 0.95 * COULOMB}, prepared, 0.02)
    assert rms(error[slow]) < 1.2 * rms(error[~slow])


def test_noise_beside_a_test_error_is_in_percent_of_the_same_torque() -> None:
    """A load makes what is fitted livelier: in N m noise alone is left, and in percent it was thrice that."""
    rng = np.random.default_rng(5)
    recording = sliding("velocity")
    torque = recording.torque + 0.2 * rng.standard_normal(len(recording))
    quiet = recording.with_channels(derived=False, torque=torque)
    load = np.full(len(recording), 30.0)
    lively = quiet.with_channels(derived=False, torque=torque + load, load_torque=load)
    line = torque_errors(DRIVE, TRUE, prepare(lively), prepare(quiet))[0].per_sample
    assert line.held_out_SI == pytest.approx(line.SI)
    assert line.held_out_percent > 2.0 * line.percent
    assert line.percent == pytest.approx(line.fit_noise_percent, rel=0.1)
    assert line.held_out_percent == pytest.approx(line.noise_floor_percent, rel=0.1)
    assert abs(line.above_noise()) < 0.2 * line.percent**2
    alone = torque_errors(DRIVE, TRUE, prepare(lively))[0].per_sample
    assert alone.noise_floor_percent == alone.fit_noise_percent == line.fit_noise_percent
