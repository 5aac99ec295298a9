"""What repeats with the motion is one event, however often it comes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.arrays import Array, Index
from fricmodels.diagnosis import compare
from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.parameter import at_bound
from fricmodels.recording import Recording
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.repeats import parts_of, phase_of

RATE = 200.0
SECONDS = 30.0


def moving(velocity: Array, run: Index | None = None, time: Array | None = None) -> Recording:
    """Return a drive that moves so."""
    stamps = np.arange(len(velocity)) / RATE if time is None else time
    channels = {"time": stamps, "torque": np.sign(velocity), "velocity": velocity}
    return Recording("moving", Motion.ROTARY, channels, np.zeros(len(velocity), dtype=np.int64) if run is None else run)


def fourier(period: float, seed: int = 0, seconds: float = SECONDS, noise: float = 0.0) -> Recording:
    """Return a drive under a Fourier series of five harmonics of random phase."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * RATE)) / RATE
    phase = 2 * np.pi * np.outer(np.arange(1, 6), time) / period + rng.uniform(0, 2 * np.pi, (5, 1))
    return moving(np.sin(phase).sum(axis=0) + noise * rng.standard_normal(len(time)))


@pytest.mark.parametrize("period", [0.8, 3.0, 7.3, 10.0, 14.0])
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_a_fourier_series_has_its_period(period: float, noise: float) -> None:
    """To a thousandth of it; each phase has the same velocity wherever in the record it is."""
    recording = fourier(period, noise=noise)
    phase = phase_of(recording)
    assert phase is not None
    assert phase.time.max() == pytest.approx(period, abs=2 * SECONDS / 2**14 + 2 / RATE)
    assert not phase.motion.any()
    apart = np.mod(recording.time - phase.time + 0.5 * period, period) - 0.5 * period
    assert np.abs(apart - np.median(apart)).max() < 0.01 * period + 1 / RATE


def test_a_sine_has_its_period_and_not_a_multiple() -> None:
    time = np.arange(6000) / RATE
    for frequency in (0.2, 1.0, 3.3):
        phase = phase_of(moving(np.sin(2 * np.pi * frequency * time)))
        assert phase is not None
        assert phase.time.max() == pytest.approx(1 / frequency, abs=0.01)


def test_what_never_comes_again_has_no_phase() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(6000) / RATE
    wandering = np.convolve(rng.standard_normal(7000), np.hanning(400), "same")[:6000]
    sweep = np.sin(2 * np.pi * (0.1 * time + 0.05 * time**2))
    moves = np.repeat(rng.standard_normal(60), 100)
    for velocity in (wandering, sweep, moves, np.full(6000, 2.0) + 0.01 * rng.standard_normal(6000)):
        assert phase_of(moving(velocity)) is None
    assert phase_of(fourier(20.0)) is None, "two thirds of it are no repetition"


def test_it_is_told_of_what_was_cut_and_wherever_time_and_direction_begin() -> None:
    recording = fourier(5.0)
    whole = phase_of(recording)
    assert whole is not None
    kept = np.ones(len(recording), dtype=bool)
    kept[700:900] = kept[3000:3600] = False
    cut = phase_of(recording.remembering().select(kept))
    assert cut is not None
    np.testing.assert_allclose(np.mod(cut.time - whole.time[kept] + 2.5, 5.0), 2.5, atol=0.05)
    later = {**recording.channels, "time": recording.time + 1000.0, "velocity": -recording.velocity}
    moved = phase_of(replace(recording, channels=later))
    assert moved is not None
    np.testing.assert_allclose(np.mod(moved.time - whole.time + 2.5, 5.0), 2.5, atol=0.01)


def test_runs_that_move_alike_are_one_motion() -> None:
    one, other = fourier(3.0, 1, 9.0).velocity, fourier(3.0, 2, 9.0).velocity
    late = np.roll(one, 150)
    run = np.repeat(np.arange(3), len(one))
    time = np.tile(np.arange(len(one)) / RATE, 3)
    phase = phase_of(moving(np.concatenate([one, other, late]), run, time))
    assert phase is not None
    assert [int(phase.motion[run == k][0]) for k in range(3)] == [0, 1, 0]
    behind = phase.time[run == 2] - phase.time[run == 0]
    np.testing.assert_allclose(np.mod(behind + 1.5 + 0.75, 3.0), 1.5, atol=0.05)
    once = np.concatenate([fourier(30.0, 1, 9.0).velocity, fourier(30.0, 2, 9.0).velocity])
    both, time = np.concatenate([once, once]), np.tile(np.arange(1800) / RATE, 4)
    phase = phase_of(moving(both, np.repeat(np.arange(4), 1800), time))
    assert phase is not None, "no run repeats itself, and two repeat the two before"
    assert phase.motion[::1800].tolist() == [0, 1, 0, 1]


def _chance(parts: Index | None, seed: int, *, repeats: int, per_period: int) -> tuple[float, float]:
    """Return both p-values of a column that has nothing to do with an error; both come again with the motion."""
    rng = np.random.default_rng(seed)
    column, error = (np.tile(rng.standard_normal(per_period), repeats) for _ in range(2))
    target = error + 0.3 * rng.standard_normal(len(error))
    evidence = Regression(np.ones((1, len(target))), target, float(len(target)), parts).test(column[None])
    return evidence.p_value, evidence.p_once


def test_an_error_that_repeats_makes_nothing_significant_that_is_not_there() -> None:
    """Of 400 columns that are not there one in a hundred passes at 1 %; counted as often as it came, a fifth does."""
    repeats, per_period = 6, 100
    parts = np.tile(np.arange(per_period), repeats)
    found = np.array([_chance(parts, seed, repeats=repeats, per_period=per_period) for seed in range(400)])
    assert np.mean(found[:, 0] < 0.01) > 0.15
    assert np.mean(found[:, 1] < 0.01) < 0.03
    assert np.all(found[:, 1] >= found[:, 0])


def test_what_is_there_stays_significant() -> None:
    """Noise alone beside it, new each time: as certain as without a thought of repetitions, but for fewer cosines."""
    rng = np.random.default_rng(3)
    column = np.tile(rng.standard_normal(100), 6)
    target = 0.3 * column + rng.standard_normal(600)
    parts = np.tile(np.arange(100), 6)
    evidence = Regression(np.ones((1, 600)), target, 600.0, parts).test(column[None])
    assert evidence.p_value <= evidence.p_once < 1e-3


def test_without_repetitions_and_with_few_rows_both_are_the_same() -> None:
    found = _chance(None, 1, repeats=1, per_period=300)
    assert found[0] == found[1]
    few = np.tile(np.arange(8), 40)
    p_value, p_once = _chance(few, 1, repeats=40, per_period=8)
    assert p_value == p_once, "eight rows tell no variance"


def test_rows_share_a_part_where_the_motion_repeats() -> None:
    recording = fourier(5.0)
    centre = np.arange(50, len(recording) - 50, 10)
    parts = parts_of(recording, centre, 10.0)
    assert parts is not None
    assert 95 <= parts.max() + 1 <= 102
    assert np.bincount(parts).max() <= 7
    assert parts_of(fourier(20.0), centre, 10.0) is None


@pytest.mark.parametrize("inertia", [2.0, 20.0])
def test_friction_of_zero_at_its_bound_where_no_column_is_free(inertia: float) -> None:
    """A drive without friction and with its inertia given; one that is too large asks for a negative friction."""
    recording = fourier(3.0)
    torque = 2.0 * np.gradient(recording.velocity, recording.time) - 1e-3 * np.sign(recording.velocity)
    model = Model.parse("coulomb-viscous")
    found = compare(recording.with_channels(derived=False, torque=torque), model, inertia).estimate.parameters
    assert found == {"K_v": 0.0, "K_c": 0.0, "J": inertia}
    assert at_bound({p.key: p.declared for p in model.parameters}, found) == ["K_v", "K_c"]
