"""Recordings: channels, runs, units, and clear refusals."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion, Scales
from fricmodels.errors import InputError
from fricmodels.recording import CHANNELS, SIGNAL_CHANNEL, Recording
from fricmodels.term import SIGNALS


def recorded(**channels: np.ndarray) -> Recording:
    time = np.array([0.0, 0.1, 0.2, 0.0, 0.1])
    base = {"time": time, "torque": np.array([0.0, 1.0, 4.0, 7.0, 9.0]), "velocity": np.arange(5.0)}
    return Recording("made", Motion.ROTARY, {**base, **channels}, np.array([0, 0, 0, 1, 1]))


def test_every_signal_of_a_term_has_a_channel_of_the_same_dimension() -> None:
    assert set(SIGNAL_CHANNEL) == set(SIGNALS)
    for signal, channel in SIGNAL_CHANNEL.items():
        assert CHANNELS[channel] == SIGNALS[signal]


def test_time_and_torque_are_always_there_and_lengths_agree() -> None:
    run = np.zeros(2, dtype=np.int64)
    with pytest.raises(InputError, match="no channel 'torque'"):
        Recording("bad", Motion.ROTARY, {"time": np.zeros(2)}, run)
    with pytest.raises(InputError, match="different lengths"):
        Recording("bad", Motion.ROTARY, {"time": np.zeros(2), "torque": np.zeros(3)}, run)


def test_a_missing_channel_is_named_with_those_that_are_there() -> None:
    with pytest.raises(InputError, match=r"no channel 'position'; it has time, torque, velocity"):
        _ = recorded()["position"]


def test_what_a_model_needs_and_the_way_out_stand_in_one_line() -> None:
    with pytest.raises(InputError) as refused:
        recorded().require(frozenset({"velocity", "temperature"}), "coulomb-viscous+thermal")
    told = str(refused.value)
    assert "'coulomb-viscous+thermal' needs the channel 'temperature'" in told
    assert "--column temperature=COLUMN[:UNIT]" in told
    assert "\n" not in told


def test_a_load_that_was_not_given_is_zero_but_no_ground_for_a_term_that_uses_it() -> None:
    recording = recorded()
    np.testing.assert_array_equal(recording.signal("load_torque"), np.zeros(5))
    with pytest.raises(InputError, match="load_torque"):
        recording.require(frozenset({"load_torque"}), "coulomb-viscous+load-friction")


def test_the_torque_rate_is_a_central_difference_that_does_not_cross_runs() -> None:
    np.testing.assert_allclose(recorded().signal("motor_torque_rate"), [10.0, 20.0, 30.0, 20.0, 20.0])
    stands = recorded(time=np.array([0.0, 0.1, 0.27, 0.0, 0.1]), torque=np.full(5, 0.7))
    np.testing.assert_array_equal(stands.signal("motor_torque_rate"), np.zeros(5))
    measured = recorded(torque_rate=np.full(5, 3.0))
    np.testing.assert_array_equal(measured.signal("motor_torque_rate"), np.full(5, 3.0))


def test_runs_are_apart() -> None:
    first, second = recorded().runs()
    assert (len(first), len(second)) == (3, 2)
    assert recorded().interval == pytest.approx(0.1)
    assert np.isnan(recorded().select(slice(0, 1)).interval)


def test_derived_channels_are_marked_until_they_are_measured() -> None:
    derived = recorded().with_channels(acceleration=np.zeros(5))
    assert derived.derived == {"acceleration"}
    assert derived.with_channels(derived=False, acceleration=np.ones(5)).derived == frozenset()
    assert "acceleration" not in recorded()


def test_change_of_units_and_back() -> None:
    scales = Scales(force=2.0, displacement=4.0, time=8.0)
    scaled = recorded().scaled(scales)
    np.testing.assert_allclose(scaled.torque, recorded().torque / 2)
    np.testing.assert_allclose(scaled.velocity, recorded().velocity * 2)
    np.testing.assert_allclose(scaled.time, recorded().time / 8)
    back = scaled.scaled(Scales(force=0.5, displacement=0.25, time=0.125))
    assert back.checksum == recorded().checksum


def test_the_checksum_knows_values_runs_names_and_kind_but_not_the_order() -> None:
    base = recorded()
    turned = Recording("other", base.motion, dict(reversed(base.channels.items())), base.run)
    assert turned.checksum == base.checksum
    assert recorded(velocity=np.arange(5.0) + 1e-12).checksum != base.checksum
    assert base.with_channels(position=base.velocity).checksum != base.checksum
    assert Recording("made", base.motion, base.channels, np.zeros(5, dtype=np.int64)).checksum != base.checksum
    assert Recording("made", Motion.LINEAR, base.channels, base.run).checksum != base.checksum


def pushed(**channels: np.ndarray) -> Recording:
    time = np.concatenate([np.arange(6), np.arange(4)]) * 0.1
    base = {"time": time, "torque": 10 * time**2, "load_torque": np.sin(time), "velocity": np.cos(time)}
    return Recording("pushed", Motion.ROTARY, {**base, **channels}, np.repeat([0, 1], [6, 4]))


def test_motion_that_is_late_takes_both_torques_as_they_were_before() -> None:
    recording = pushed()
    retimed = recording.retimed(0.1)
    for name in ("torque", "load_torque"):
        for run in (0, 1):
            before, after = (r.channels[name][r.run == run] for r in (recording, retimed))
            np.testing.assert_allclose(after, [before[0], *before[:-1]])
    np.testing.assert_array_equal(retimed.velocity, recording.velocity)


def test_a_torque_that_is_late_leaves_load_and_motion_alone() -> None:
    recording = pushed()
    retimed = recording.retimed(-0.05)
    torque = recording.torque[recording.run == 1]
    np.testing.assert_allclose(retimed.torque[retimed.run == 1], [*(torque[1:] + torque[:-1]) / 2, torque[-1]])
    np.testing.assert_array_equal(retimed.load_torque, recording.load_torque)


@pytest.mark.parametrize("delay", [0.13, -0.13])
def test_the_change_over_a_delay_is_what_retiming_takes_away(delay: float) -> None:
    recording = pushed()
    retimed = recording.retimed(delay)
    taken = recording.torque - recording.load_torque - retimed.torque + retimed.load_torque
    np.testing.assert_allclose(recording.change_over(delay, recording), taken, atol=1e-15)


def test_a_delay_without_length_takes_the_rate_of_the_torque() -> None:
    recording = pushed()
    inside = np.array([1, 2, 3, 4])
    both = [recording.change_over(delay, recording) / delay for delay in (1e-6, -1e-6)]
    rate = recording.signal("motor_torque_rate") - np.gradient(recording.load_torque, 0.1)
    late = np.diff(recording.torque - recording.load_torque)[:4] / 0.1
    np.testing.assert_allclose(both[0][inside], late, rtol=1e-6)
    np.testing.assert_allclose(both[1][inside], np.diff(recording.torque)[1:5] / 0.1, rtol=1e-6)
    np.testing.assert_allclose(recording.retimed(1e-9).signal("motor_torque_rate")[inside], rate[inside], rtol=1e-6)


def test_what_was_found_stays_where_its_channel_stays() -> None:
    time = 0.01 * np.arange(100)
    channels = {"time": time, "torque": np.ones(100), "velocity": np.sin(time)}
    recording = Recording("one", Motion.ROTARY, channels, np.zeros(100, dtype=np.int64))
    assert (recording.interval, recording.peak_speed) == pytest.approx((0.01, np.sin(0.99)))
    faster, later = recording.with_channels(velocity=3.0 * np.sin(time)), recording.with_channels(time=2.0 * time)
    assert (faster.interval, faster.peak_speed) == pytest.approx((0.01, 3.0 * np.sin(0.99)))
    assert (later.interval, later.peak_speed) == pytest.approx((0.02, np.sin(0.99)))
