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
