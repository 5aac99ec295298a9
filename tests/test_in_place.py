"""What positions and stamps say of a motion that its velocity channel does not."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.logcheck import findings
from fricmodels.recording import Recording
from fricmodels.signals import noise_of, resting
from fricmodels.signals.beginnings import false_beginnings, with_true_beginnings
from fricmodels.signals.differences import is_difference
from fricmodels.signals.stamp_noise import with_false_stamps
from fricmodels.weakform.prepared import ready

STEP = 0.002


def recorded(position: np.ndarray, velocity: np.ndarray | None, time: np.ndarray | None = None) -> Recording:
    count = len(position)
    stamps = STEP * np.arange(count) if time is None else time
    channels = {"time": stamps, "torque": np.sin(stamps), "position": position}
    if velocity is not None:
        channels["velocity"] = velocity
    return Recording("made", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64))


def test_noise_of_the_velocity_does_not_break_a_rest_in_which_the_position_stands() -> None:
    time = STEP * np.arange(6000)
    inside = (time % 3.0) > 1.5
    true = np.where(inside, 0.0, 2.0 * np.sin(np.pi * (time % 3.0) / 1.5))
    position = np.round(np.cumsum(true) * STEP / 1e-5) * 1e-5
    rng = np.random.default_rng(1)
    noise = np.zeros(len(time))
    for k in range(1, len(time)):
        noise[k] = 0.95 * noise[k - 1] + 0.002 * rng.standard_normal()
    rest = resting(recorded(position, true + noise))
    core = inside & ((time % 3.0) > 1.6) & ((time % 3.0) < 2.9)
    assert rest[core].all()
    assert not rest[np.abs(true) > 0.2].any()


@pytest.mark.parametrize("measured", [True, False])
def test_a_drive_that_creeps_below_standstill_rests_however_exact_its_sensors_are(measured: bool) -> None:
    """A drive that stands yields a little to what pushes it. An exact sensor shows that, its last digits the end."""
    time = STEP * np.arange(6000)
    inside = (time % 3.0) > 1.5
    moving = 2.0 * np.sin(np.pi * (time % 3.0) / 1.5)
    true = np.where(inside, 1e-5 * np.exp(-((time % 3.0) - 1.5) / 0.2), moving)
    position = np.cumsum(true) * STEP
    changed = position * (1.0 + 1e-9 * np.random.default_rng(0).uniform(-1.0, 1.0, len(time)))
    rests = [resting(recorded(each, true if measured else None)) for each in (position, changed)]
    core = inside & ((time % 3.0) > 1.52) & ((time % 3.0) < 2.98)
    assert rests[0][core].all()
    assert not rests[0][np.abs(true) > 0.1].any()
    np.testing.assert_array_equal(rests[0], rests[1])


def test_a_drive_that_moves_between_two_rests_is_not_called_resting() -> None:
    time = STEP * np.arange(3000)
    true = np.where((time > 2.9) & (time < 3.1), 0.5 * np.sin(20 * np.pi * (time - 2.9)), 0.0)
    position = np.round(np.cumsum(true) * STEP / 1e-5) * 1e-5
    rest = resting(recorded(position, true + 1e-3 * np.random.default_rng(2).standard_normal(3000)))
    assert rest[(time > 0.5) & (time < 2.8)].all()
    assert not rest[np.abs(true) > 0.1].any()


def test_a_first_velocity_that_a_difference_began_with_is_replaced_and_said() -> None:
    time = STEP * np.arange(500)
    velocity = 5.0 * np.cos(7.0 * time)
    spoilt = velocity.copy()
    spoilt[0] = 0.0
    recording = recorded(np.cumsum(velocity) ** 2, spoilt)
    assert false_beginnings(recording).tolist() == [0]
    assert with_true_beginnings(recording).velocity[0] == pytest.approx(velocity[0], abs=1e-2)
    assert any(one.kind == "false-beginning" for one in findings(recording))
    assert not len(false_beginnings(recorded(recording["position"], velocity)))


@pytest.mark.parametrize("form", ["backward", "forward", "central"])
def test_a_velocity_that_is_a_difference_of_the_positions_gives_way_to_them(form: str) -> None:
    rng = np.random.default_rng(3)
    time = STEP * np.arange(2000)
    position = np.round((np.sin(3 * time) + 0.2 * np.sin(11 * time)) / 1e-4) * 1e-4
    change = np.diff(position) / STEP
    velocity = {
        "backward": np.r_[0.0, change],
        "forward": np.r_[change, 0.0],
        "central": np.gradient(position, STEP),
    }[form]
    assert is_difference(recorded(position, velocity))
    assert "velocity" in ready(recorded(position, velocity)).derived
    measured = velocity + 0.02 * rng.standard_normal(2000)
    assert not is_difference(recorded(position, measured))


def test_a_measured_velocity_of_a_fast_log_is_no_difference() -> None:
    """At 4 kHz it equals the central difference to a thousandth, and is far more exact: positions have six decimals."""
    time = 2.5e-4 * np.arange(20_000)
    position = 8.0 * (time + np.sin(3.0 * time) / 6.0)
    velocity = 8.0 * (1.0 + 0.5 * np.cos(3.0 * time))
    rounded = np.round(position, 6)
    assert np.abs(np.gradient(rounded, time) - velocity)[1:-1].max() < 1e-3 * np.sqrt(np.mean(velocity**2))
    channels = {"time": time, "torque": np.zeros(20_000), "velocity": velocity, "position": rounded}
    log = Recording("fast", Motion.ROTARY, channels, np.zeros(20_000, dtype=np.int64))
    assert not is_difference(log)
    assert is_difference(log.with_channels(derived=False, velocity=np.gradient(rounded, time)))


@pytest.mark.parametrize("seed", range(3))
def test_false_stamps_show_where_the_drive_is_fast(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time = STEP * np.arange(4000)
    off = 0.1 * STEP * rng.standard_normal(4000)

    def place(at: np.ndarray) -> np.ndarray:
        return np.asarray(np.sin(3 * at) + 0.5 * np.sin(7.3 * at))

    own = 1e-6 * rng.standard_normal(4000)
    false, true = recorded(place(time + off) + own, None), recorded(place(time + off) + own, None, time + off)
    noise = noise_of(false.time, false["position"], false.run)
    found = with_false_stamps(false, noise)
    speed = 3 * np.cos(3 * time) + 3.65 * np.cos(7.3 * time)
    error = place(time + off) - place(time)
    assert found.scale is not None
    assert found.deviation == pytest.approx(np.std(error), rel=0.15)
    fast = np.abs(speed) > np.quantile(np.abs(speed), 0.9)
    assert found.deviation * np.sqrt(np.mean(found.scale[fast] ** 2)) == pytest.approx(np.std(error[fast]), rel=0.15)
    assert found.slow is noise
    quiet = noise_of(true.time, true["position"], true.run)
    assert with_false_stamps(true, quiet) is quiet


def test_noise_that_is_the_same_everywhere_is_left_as_it_is() -> None:
    rng = np.random.default_rng(5)
    time = STEP * np.arange(4000)
    recording = recorded(np.sin(3 * time) + 1e-4 * rng.standard_normal(4000), None)
    noise = noise_of(recording.time, recording["position"], recording.run)
    assert with_false_stamps(recording, noise) is noise
