"""Times at which a logger wrote its last values again and again: no samples, but no rest and no polling either."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels import diagnose
from fricmodels.dimension import Motion
from fricmodels.logcheck import findings
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.signals.outages import without_outages

Made = Callable[..., Recording]
HELD = ((500, 540), (2000, 2010), (5000, 5200))


def held(recording: Recording, *channels: str, stretches: tuple[tuple[int, int], ...] = HELD) -> Recording:
    """Return a recording in which channels keep the value at the beginning of each stretch to its end."""
    found = {}
    for name in channels:
        found[name] = recording[name].copy()
        for first, last in stretches:
            found[name][first : last + 1] = found[name][first]
    return recording.with_channels(derived=False, **found)


@pytest.fixture
def clean(made: Made) -> Recording:
    recording = made(samples=8000, noise=0.2)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(recording))
    return recording.with_channels(derived=False, torque=recording.torque + noise)


@pytest.mark.parametrize("channels", [("torque", "velocity", "position"), ("torque", "velocity")])
def test_rows_of_outages_are_left_out(clean: Recording, channels: tuple[str, ...]) -> None:
    without = {name: values for name, values in clean.channels.items() if name in ("time", *channels)}
    recording = held(Recording("log", clean.motion, without, clean.run), *channels)
    found = without_outages(recording)
    assert found.provenance["outages"]["times"] == 3
    assert len(recording) - len(found) == sum(last - first for first, last in HELD)
    assert not {recording.time[first + 1] for first, _ in HELD} & set(found.time.tolist())


def test_a_log_with_outages_has_no_other_answer(clean: Recording, tmp_path: Path) -> None:
    lost = held(clean, "torque", "velocity", "position")
    units = {"time": "time_s", "torque": "torque_Nm", "velocity": "velocity_rad_s", "position": "position_rad"}
    table = pd.DataFrame({units[name]: lost[name] for name in units})
    table.to_csv(tmp_path / "lost.csv", index=False)
    recording = read(tmp_path / "lost.csv")
    assert any("250 rows" in one.text for one in findings(recording) if one.kind == "repeated-samples")
    found = diagnose(recording, "coulomb-viscous", 2.0)
    assert found.verdict == "adequate"
    expected = diagnose(clean, "coulomb-viscous", 2.0).comparison.estimate.parameters
    assert found.comparison.estimate.parameters == pytest.approx(expected, rel=0.01)


def test_a_drive_that_rests_has_lost_nothing(clean: Recording) -> None:
    """Switched off: all channels stand still, and the motion goes on from where it was."""
    time = clean.time
    speed = np.clip(np.sin(2.0 * np.pi * time / 4.0), 0.0, None)  # two seconds of motion, two of rest, in turn
    position = np.cumsum(speed) * 0.002
    torque = np.where(speed > 0.0, 0.5 + 0.1 * speed + clean.torque * 0.01, 0.0)
    channels = {"time": time, "torque": torque, "velocity": speed, "position": position}
    recording = Recording("rests", clean.motion, channels, clean.run)
    assert without_outages(recording) is recording


@pytest.mark.parametrize("rest", [0.0, 5.0])
@pytest.mark.parametrize("with_position", [False, True])
def test_a_step_after_rest_or_steady_motion_has_lost_nothing(rest: float, with_position: bool) -> None:
    """A small motor under steps of a command, its speed in coarse steps: it stands, then runs, and starts in a row."""
    time = 0.02 * np.arange(600)
    command = np.where((time > 2.0) & (time < 7.0), 12.0 + 2.0 * np.sin(3.0 * time), rest)
    speed = np.zeros_like(time)
    for row in range(1, len(time)):
        speed[row] = speed[row - 1] + 0.3 * (command[row] - speed[row - 1])
    channels = {"time": time, "torque": command, "velocity": np.round(speed / 0.7) * 0.7}
    if with_position:
        channels["position"] = np.round(np.cumsum(0.02 * speed) / 0.01) * 0.01
    recording = Recording("step", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    assert without_outages(recording) is recording


def test_one_channel_that_is_held_is_another_matter(clean: Recording) -> None:
    recording = held(clean, "torque")
    assert without_outages(recording) is recording


def test_coarse_channels_repeat_by_chance(clean: Recording) -> None:
    coarse = {name: np.round(clean[name] / step) * step for name, step in (("torque", 2.0), ("velocity", 0.5))}
    channels = {"time": clean.time, **coarse}
    recording = Recording("coarse", clean.motion, channels, clean.run)
    assert without_outages(recording) is recording


def test_speeds_beside_an_outage_are_of_its_own_run(clean: Recording) -> None:
    """An outage three rows before the end of a run; the next run begins far away."""
    lost = held(clean, "torque", "velocity", "position", stretches=((3000, 3100),))
    index = np.r_[0:3104, 6000:8000]
    run = np.repeat([0, 1], [3104, 2000])
    cut = lost.select(index)
    moved = cut.with_channels(derived=False, position=cut["position"] + 1000.0 * run)
    found = without_outages(Recording("runs", clean.motion, moved.channels, run.astype(np.int64)))
    assert found.provenance["outages"]["rows"] == 100


def test_a_rest_from_which_a_drive_turns_back_at_once_loses_nothing() -> None:
    """Ten samples a second: from rest to full speed is one jump, and back where it came from as long a way."""
    rest, go = np.zeros(12), np.r_[4.0, np.full(20, 0.5)]
    speed = np.concatenate([part for _ in range(6) for part in (rest, go, rest, -go)])
    time = 0.1 * np.arange(len(speed))
    position = np.cumsum(0.1 * np.r_[speed[1:], 0.0])  # the velocity comes a sample after the position
    channels = {"time": time, "torque": 0.5 * np.sign(speed), "velocity": speed, "position": position}
    recording = Recording("valve", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    assert without_outages(recording) is recording
