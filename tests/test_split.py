from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pydantic import ValidationError

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.results.comparison import Samples
from fricmodels.split import WHOLE_RUNS, Split, period, split


def recording(time, run=None, **channels):
    run = np.zeros(len(time), dtype=np.int64) if run is None else run
    torque = channels.pop("torque", np.ones_like(time))
    return Recording("r", Motion.ROTARY, {"time": time, "torque": torque, **channels}, run)


def several_runs(count=5, samples=40):
    time = np.tile(np.linspace(0, 3.9, samples), count) + np.repeat(100.0 * np.arange(count), samples)
    return recording(time, np.repeat(np.arange(count), samples), velocity=np.sin(time))


HOWS = st.one_of(
    st.builds(Split, by=st.just("spread"), fraction=st.floats(0.01, 0.99)),
    st.builds(Split, by=st.just("runs"), fraction=st.floats(0.01, 0.99)),
    st.builds(Split, by=st.just("time"), fraction=st.floats(0.1, 0.9)),
    st.builds(Split, by=st.just("blocks"), fraction=st.floats(0.01, 0.99), blocks=st.integers(2, 20)),
    st.builds(Split, by=st.just("cycles"), period=st.floats(0.2, 1.5)),
)


@given(HOWS)
def test_each_sample_is_in_one_part_and_the_same_one_again(how):
    whole = several_runs()
    train, test = split(whole, how)
    assert len(train) > 0
    assert len(test) > 0
    np.testing.assert_array_equal(np.sort(np.r_[train.time, test.time]), whole.time)
    again = split(whole, Split.model_validate_json(how.model_dump_json()))
    assert [part.checksum for part in again] == [train.checksum, test.checksum]
    for part in (train, test):
        within = np.diff(part.run) == 0
        assert np.diff(part.time)[within].max(initial=0.0) < 0.11


@example(Split(by="blocks", fraction=0.375, blocks=13), 412.0)  # where samples lie on the borders of blocks
@given(HOWS, st.floats(-1e3, 1e3))
def test_the_origin_of_time_does_not_matter(how, shift):
    whole = several_runs()
    moved = whole.with_channels(time=np.round(whole.time + shift, 6) - 0.0)
    assert len(split(whole, how)[1]) == len(split(moved, how)[1])


def test_by_runs():
    train, test = split(several_runs(), Split(by="runs", fraction=0.4))
    assert (set(train.run.tolist()), set(test.run.tolist())) == ({0, 1, 2}, {3, 4})
    train, test = split(several_runs(), Split(by="runs", test_runs=(1, "3")[:1]))
    assert set(test.run.tolist()) == {1}
    named = replace(several_runs(2), provenance={"runs": {0: "slow", 1: "fast"}})
    train, test = split(named, Split(by="runs", test_runs=("slow",)))
    assert (set(train.run.tolist()), set(test.run.tolist())) == ({1}, {0})
    with pytest.raises(InputError, match="no run 'medium'; it has slow, fast"):
        split(named, Split(by="runs", test_runs=("medium",)))
    with pytest.raises(InputError, match="--column run=COLUMN"):
        split(several_runs(1), Split(by="runs"))
    with pytest.raises(InputError, match="nothing to fit"):
        split(named, Split(by="runs", test_runs=("slow", "fast")))


def test_by_time_keeps_the_end_of_each_run_or_a_piece():
    train, test = split(several_runs(2), Split(by="time", fraction=0.25))
    assert set(test.run.tolist()) == {0, 1}
    for run in (0, 1):
        assert test.time[test.run == run].min() > train.time[train.run == run].max()
    train, test = split(several_runs(2), Split(test_from=1.0, test_to=2.0))
    np.testing.assert_allclose([test.time.min(), test.time.max()], [1.0, 102.0], atol=1e-9)
    assert len(set(train.run.tolist())) == 4
    with pytest.raises(InputError, match="nothing to score"):
        split(several_runs(2), Split(test_from=50.0))


def test_the_usual_split_is_spread_over_record_and_runs():
    one = recording(np.linspace(0, 10, 1000))
    np.testing.assert_array_equal(split(one)[1].time, split(one, Split(by="blocks"))[1].time)
    assert sorted(set(split(several_runs(7))[1].run.tolist())) == [1, 5]


def test_runs_that_are_kept_back_whole_are_known_by_name():
    def whole(recording, how):
        return split(recording, how)[1].provenance[WHOLE_RUNS]

    several = replace(several_runs(), provenance={"runs": {i: f"lap {i}" for i in range(5)}})
    assert whole(several, Split()) == tuple(f"lap {i}" for i in np.unique(split(several, Split())[1].run))
    assert whole(several_runs(), Split(by="runs", test_runs=(1, 3))) == ("1", "3")
    assert whole(several_runs(2), Split()) == ()
    assert whole(several, Split(by="time")) == ()


def test_a_piece_of_a_run_is_no_whole_run_whatever_its_number():
    one = replace(several_runs(1), run=np.full(40, 5))
    fitted, kept_back = split(one, Split(by="time", test_from=1.0, test_to=2.0))
    assert not set(fitted.run) & set(kept_back.run)
    assert kept_back.provenance[WHOLE_RUNS] == ()


def test_blocks_are_spread():
    _, test = split(recording(np.linspace(0, 10, 1000)), Split(by="blocks", fraction=0.3, blocks=10))
    assert sorted({int(t) for t in test.time}) == [1, 5, 8]


@pytest.mark.parametrize(("rest", "kept"), [((2.2, 3.6), [2, 6, 9]), ((2.2, 3.1), [1, 5, 8]), ((5.2, 6.6), [1, 5, 8])])
def test_blocks_kept_back_hold_what_the_drive_does_for_long(rest, kept):
    """A rest of more than a block's time that lies in none of the usual blocks moves them on by one."""
    time = np.linspace(0, 10, 5000)
    resting = (time > rest[0]) & (time < rest[1])
    velocity = np.where(resting, 0.0, np.sin(2 * np.pi * time / 0.2))
    _, test = split(recording(time).with_channels(torque=velocity, velocity=velocity))
    assert sorted({min(int(t), 9) for t in test.time}) == kept


@pytest.mark.parametrize("pause", [1.0, 3600.0])
def test_a_pause_takes_no_part_of_the_blocks(pause):
    """A log of two sessions with an hour between: no block may lie in the hour, where nothing is."""
    time = np.linspace(0, 10, 1001)
    whole = recording(time)
    apart = recording(np.where(time > 4.005, time + pause, time))
    kept = np.isin(apart.time, split(apart)[1].time)
    np.testing.assert_array_equal(kept, np.isin(whole.time, split(whole)[1].time))


@pytest.mark.parametrize("cycle", [0.5, 0.333, 1.7])
@pytest.mark.parametrize("level", [0.0, 0.2])
def test_the_period_is_found(cycle, level):
    time = np.arange(0, 8, 0.004)
    rng = np.random.default_rng(0)
    angle = 2 * np.pi * time / cycle
    torque = np.sin(angle) + 0.5 * np.sin(2 * angle + 1) + level * rng.standard_normal(len(time))
    velocity = np.cos(angle) + 0.3 * np.cos(3 * angle) + level * rng.standard_normal(len(time))
    whole = recording(time, torque=torque, velocity=velocity)
    assert period(whole) == pytest.approx(cycle, rel=5e-3)
    train, test = split(whole, Split(by="cycles", test_cycles=2))
    assert test.time.min() == pytest.approx(time[-1] - 2 * cycle, abs=0.02)
    assert len(train) + len(test) == len(whole)


def test_the_period_does_not_depend_on_units():
    time = np.arange(0, 8, 0.004)
    torque = np.sin(9 * time)
    one = period(recording(time, torque=torque, velocity=np.cos(9 * time)))
    other = period(recording(60 * time + 3, torque=1e3 * torque, velocity=-1e-3 * np.cos(9 * time)))
    assert other == pytest.approx(60 * one)


@pytest.mark.parametrize("signal", [np.random.default_rng(0).standard_normal(800).cumsum(), np.arange(800.0)])
def test_motion_without_period(signal):
    with pytest.raises(InputError, match="does not repeat itself"):
        period(recording(np.arange(800) * 0.01, torque=signal, velocity=signal))


@pytest.mark.parametrize(
    "values",
    [{"by": "run"}, {"by": "runs", "blocks": 4}, {"fraction": 1.0}, {"by": "time", "test_runs": [1]}, {"fracton": 0.2}],
)
def test_settings_that_mean_nothing_are_refused(values):
    with pytest.raises(ValidationError):
        Split.model_validate(values)


@pytest.mark.parametrize(
    ("runs", "words"),
    [
        ((), "20 for the test error"),
        (("2",), "20 for the test error (run 2, whole)"),
        (("a", "b"), "20 for the test error (runs a, b, whole)"),
        (tuple("abcdef"), "20 for the test error (6 runs, whole)"),
    ],
)
def test_runs_that_are_kept_back_whole_are_said(runs, words):
    assert Samples(fitted=80, kept_back=20, kept_back_runs=runs).in_the_test_error == words
