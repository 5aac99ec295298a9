"""Samples that are none: polled less often than logged, or lost and kept at the last value."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from fricmodels.dimension import Motion
from fricmodels.logcheck import Finding, findings
from fricmodels.recording import Recording

SAMPLES = 12_000
INTERVAL = 2e-3
TIME = INTERVAL * np.arange(SAMPLES)


def drive(seed: int = 0, noise: float = 0.02) -> Recording:
    """Return a drive moved by three sines, with noise on its torque and its velocity."""
    rng = np.random.default_rng(seed)
    frequencies, sizes, phases = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0]), rng.uniform(0, 6, 3)
    angle = np.outer(TIME, frequencies) + phases
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / frequencies)
    torque = 0.05 * np.cos(angle) @ (sizes * frequencies) + 0.1 * velocity + 0.6 * np.sign(velocity)
    channels = {
        "time": TIME,
        "torque": torque + noise * rng.standard_normal(SAMPLES),
        "velocity": velocity + noise * rng.standard_normal(SAMPLES),
        "position": 1e-4 * np.round(position / 1e-4),
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


DRIVE = drive()
TORQUE, VELOCITY = DRIVE.torque, DRIVE.velocity


def changed(recording: Recording = DRIVE, **channels: np.ndarray) -> Recording:
    return replace(recording, channels={**recording.channels, **channels})


def found(**channels: np.ndarray) -> list[Finding]:
    return [one for one in findings(changed(**channels)) if one.kind == "repeated-samples"]


def dropped(values: np.ndarray, seed: int = 1, longest: float = 0.15) -> tuple[np.ndarray, int]:
    """Return a channel that is held every 1.5 s for 20 ms or longer, and how many samples are held."""
    rng, kept, count = np.random.default_rng(seed), values.copy(), 0
    for start in np.arange(0.7, TIME[-1] - 1.0, 1.5):
        first, length = int(start / INTERVAL), int(rng.uniform(0.02, longest) / INTERVAL)
        kept[first : first + length + 1] = kept[first]
        count += length
    return kept, count


@pytest.mark.parametrize("channel", ["torque", "velocity"])
@pytest.mark.parametrize("step", [0.0, 1e-3, 0.01])
def test_a_noisy_channel_that_stands_still_now_and_then_has_lost_values(channel: str, step: float) -> None:
    values = DRIVE[channel]
    kept, count = dropped(step * np.round(values / step) if step else values)
    (one,) = found(**{channel: kept})
    assert one.channel == channel
    assert "stands exactly still" in one.text
    times, share = (float(one.text.partition(before)[2].split()[0]) for before in ("exactly still ", " ms, "))
    assert 12 <= times <= 16
    assert share == pytest.approx(100 * count / SAMPLES, rel=0.25)
    assert "--gaps drop" in one.remedy


def test_a_smooth_channel_that_stands_still_and_jumps_has_lost_values() -> None:
    smooth = drive(noise=0.0).torque
    (one,) = found(torque=np.round(dropped(smooth)[0], 6))
    assert "stands exactly still" in one.text


def ramps_and_steps() -> np.ndarray:
    """Return a command of ramps with plateaus, and of steps in the last third."""
    ramps = np.clip(np.abs((TIME % 1.2) - 0.6) * 4.0, 0.3, 1.7) * (1.0 + 0.1 * np.floor(TIME / 0.6))
    steps = np.repeat(np.random.default_rng(2).standard_normal(SAMPLES // 50), 50)
    return np.round(np.where(np.arange(SAMPLES) < 2 * SAMPLES // 3, ramps, steps), 6)


def smoothed_counts() -> np.ndarray:
    """Return the change of a coarse position after a short low-pass filter: it comes to rest at whole counts."""
    step = 2e-3
    speed = np.r_[0.0, np.diff(step * np.round(DRIVE["position"] / step))] / INTERVAL
    return np.round(lfilter([0.95], [1.0, -0.05], speed), 5)


SOUND = {
    "as it is": {},
    "no noise": {"torque": np.round(np.clip(2.0 * np.sin(3.0 * TIME), -1.5, 1.5), 6)},
    "coarse steps": {"torque": 0.1 * np.round(TORQUE / 0.1)},
    "steps as large as the noise": {"torque": 0.02 * np.round(TORQUE / 0.02)},
    "a limit": {"torque": np.clip(TORQUE, -0.9, 0.9)},
    "a limit within": {"torque": np.where(np.abs(TORQUE) < 0.2, 0.2, TORQUE)},
    "a command in steps": {"torque": np.repeat(np.random.default_rng(2).standard_normal(SAMPLES // 50), 50)},
    "ramps and steps": {"torque": ramps_and_steps()},
    "smoothed counts": {"velocity": smoothed_counts()},
}


@pytest.mark.parametrize("name", SOUND)
def test_a_channel_that_repeats_itself_by_right_is_not_accused(name: str) -> None:
    assert not found(**SOUND[name])


def test_at_rest_values_may_stay_as_they_are() -> None:
    rest = (np.arange(SAMPLES) // 300) % 4 == 3
    last = np.maximum.accumulate(np.where(rest, 0, np.arange(SAMPLES)))
    assert not found(
        torque=TORQUE[last], velocity=np.where(rest, 0.0, VELOCITY), position=np.cumsum(np.where(rest, 0.0, VELOCITY))
    )


@pytest.mark.parametrize("steps", [False, True])
def test_a_velocity_made_of_counts_stays_while_they_come_evenly(steps: bool) -> None:
    """A drive low-passes its counts at its own rate, and logs every eighth: at a count a sample it is one number."""
    rng, count, fine = np.random.default_rng(0), 2 * np.pi / 4096, np.arange(8 * SAMPLES) * INTERVAL / 8
    speed = np.where(fine % 1.2 < 0.6, 1.0, 2.0) if steps else 1.0 + 0.02 * np.sin(fine)
    position = count * np.floor(np.cumsum(speed + 0.01 * np.sin(30.0 * fine)) / 8 + rng.uniform())
    velocity = lfilter([0.375], [1.0, -0.625], np.r_[0.0, np.diff(position)])[::8] * 8 / INTERVAL
    torque = 0.1 * velocity + 0.02 * rng.standard_normal(SAMPLES)
    assert not found(position=position[::8], velocity=np.round(velocity, 4), torque=torque)


@pytest.mark.parametrize("every", [3, 8])
def test_how_often_a_value_is_new_is_counted(every: int) -> None:
    (one,) = found(torque=np.repeat(TORQUE[::every], every)[:SAMPLES])
    assert f"{100 * (1 - 1 / every):.2g} % of the samples" in one.text
    assert f"a new one every {every} samples" in one.text


def test_the_share_of_single_repetitions_is_counted() -> None:
    again = np.random.default_rng(0).random(SAMPLES) < 0.1
    again[0] = False
    (one,) = found(torque=np.where(again, np.r_[0.0, TORQUE[:-1]], TORQUE))
    assert 9.0 <= float(one.text.split()[0]) <= 11.0


def test_no_finding_writes_a_percentage_as_a_power_of_ten() -> None:
    """Nor a size: 99.7 % in two figures is 100 %, and 12 345 N m are no 1.234e+04."""
    spoilt = (
        changed(torque=np.repeat(TORQUE[::8], 8)[:SAMPLES]),
        changed(torque=1e4 * np.clip(TORQUE, -0.1, 0.1)),
        changed(torque=np.where(np.arange(SAMPLES) == 500, 4e5, 1e4 * TORQUE)),
        changed(velocity=VELOCITY * 1e-3 + 0.02 * np.random.default_rng(2).standard_normal(SAMPLES)),
        changed(time=np.where(np.arange(SAMPLES) > 6000, TIME + 34.56, TIME)),
    )
    texts = [str(one) for recording in spoilt for one in findings(recording, 0.05)]
    assert len(texts) > 5
    assert not [text for text in texts if "e+0" in text]
