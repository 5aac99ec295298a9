"""A sensor that reads nothing below a threshold, and what looks like one and is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.logcheck import Finding, findings
from fricmodels.recording import Recording

SAMPLES = 10_000
INERTIA = 0.05
TIME = 4e-3 * np.arange(SAMPLES)
NOISE = np.random.default_rng(5).standard_normal(SAMPLES)


def drive(noise: float = 0.03) -> Recording:
    """Return a drive moved by three sines, at rest for the first tenth of the record."""
    frequencies, sizes, phases = np.array([2.1, 5.3, 9.7]), np.array([3.0, 2.0, 1.0]), np.array([0.3, 2.0, 4.0])
    angle = np.outer(TIME, frequencies) + phases
    velocity, position = np.sin(angle) @ sizes, -np.cos(angle) @ (sizes / frequencies)
    torque = INERTIA * np.cos(angle) @ (sizes * frequencies) + 0.1 * velocity + 0.3 * np.sign(velocity)
    rest = np.arange(SAMPLES) < SAMPLES // 10
    position = np.where(rest, position[SAMPLES // 10], position)
    channels = {
        "time": TIME,
        "torque": np.where(rest, 0.0, torque) + noise * NOISE,
        "velocity": np.where(rest, 0.0, velocity) + 0.002 * NOISE[::-1],
        "position": 1e-4 * np.round(position / 1e-4),
    }
    return Recording("log", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


DRIVE = drive()
TORQUE, VELOCITY = DRIVE.torque, DRIVE.velocity


def found(name: str = "torque", values: np.ndarray = TORQUE, kind: str = "dead-band") -> list[Finding]:
    recording = replace(DRIVE, channels={**DRIVE.channels, name: values})
    return [one for one in findings(recording, INERTIA) if one.kind == kind]


def dead(values: np.ndarray, threshold: float, about: float = 0.0) -> np.ndarray:
    return np.where(np.abs(values - about) < threshold, about, values)


@pytest.mark.parametrize("about", [0.0, 0.25])
@pytest.mark.parametrize("step", [0.0, 0.005])
def test_a_torque_that_reads_one_value_below_a_threshold_is_named(about: float, step: float) -> None:
    torque = step * np.round(TORQUE / step) if step else TORQUE
    (one,) = found(values=dead(torque, 0.18, about))
    assert one.channel == "torque"
    assert "while the drive moves" in one.text
    assert f"exactly {about:g} N m" in one.text
    assert f"{about + 0.18:.2g}" in one.text or f"{about + 0.181:.3g}" in one.text


def test_a_velocity_that_reads_zero_at_low_speeds_is_named() -> None:
    (one,) = found("velocity", dead(VELOCITY, 0.4))
    assert "0 rad/s" in one.text


def coasting() -> np.ndarray:
    """Return a torque that is switched off now and then, from whatever it was."""
    off = (np.arange(SAMPLES) // 200) % 3 == 2
    return np.where(off, 0.0, np.sign(TORQUE) * (0.3 + np.abs(TORQUE)))


SOUND = {
    "as it is": TORQUE,
    "coarse steps": 0.2 * np.round(TORQUE / 0.2),
    "coarse steps, few digits": np.round(TORQUE, 1),
    "a relay": np.where(TORQUE > 0, 1.0, -1.0),
    "a relay with a pause": np.where(np.abs(TORQUE) < 0.3, 0.0, np.sign(TORQUE)),
    "a relay with a pause, and noise": np.where(np.abs(TORQUE) < 0.3, 0.0, np.sign(TORQUE) + 0.05 * NOISE),
    "switched off now and then": coasting(),
    "a torque of one sign": np.where(np.arange(SAMPLES) < SAMPLES // 10, 0.0, 0.5 + np.abs(TORQUE)),
    "a jump over zero": TORQUE + 0.5 * np.sign(TORQUE),
    "clipped": np.clip(TORQUE, -0.6, 0.6),
    "zero at rest": np.where(np.arange(SAMPLES) < SAMPLES // 10, 0.0, TORQUE + 0.3 * np.sign(TORQUE)),
}


@pytest.mark.parametrize("name", SOUND)
def test_what_is_no_dead_band_is_not_accused(name: str) -> None:
    assert not found(values=SOUND[name])


@pytest.mark.parametrize("name", SOUND)
def test_none_of_these_is_called_one_that_lost_values(name: str) -> None:
    assert not found(values=SOUND[name], kind="repeated-samples")


def test_a_velocity_in_counts_is_no_dead_band() -> None:
    assert not found("velocity", 0.3 * np.round(VELOCITY / 0.3))
