"""A velocity that has another scale than the position beside it, and velocities that only look so."""

from __future__ import annotations

import shlex
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import filtfilt, lfilter

from fricmodels.dimension import Motion
from fricmodels.logcheck import Severity, findings
from fricmodels.logcheck.scale import other_scale, velocity_scale
from fricmodels.readers import units
from fricmodels.recording import Recording
from fricmodels.weakform.prepared import ready

INTERVAL, SAMPLES = 2e-3, 12_000


def logged(scale: float = 1.0, *, counts: float = 2**16, noise: float = 5e-3, smoothing: float = 1.0) -> Recording:
    """Return a drive with an encoder and a tachometer.

    Args:
        scale: of the tachometer.
        counts: of the encoder, a turn.
        noise: of the tachometer [rad/s].
        smoothing: α of v += α (ω - v).
    """
    rng = np.random.default_rng(0)
    time = INTERVAL * np.arange(SAMPLES)
    waves = list(zip((0.1, 0.23, 0.41, 0.6, 1.7), rng.uniform(0.0, 6.0, 5), (0.8, 0.6, 0.4, 0.3, 0.1), strict=True))
    position = np.sum([a * np.sin(2 * np.pi * f * time + phase) for f, phase, a in waves], axis=0)
    rate = np.sum([2 * np.pi * f * a * np.cos(2 * np.pi * f * time + phase) for f, phase, a in waves], axis=0)
    seen = np.round(position * counts / (2 * np.pi)) * 2 * np.pi / counts
    velocity = scale * lfilter([smoothing], [1.0, smoothing - 1.0], rate + noise * rng.standard_normal(SAMPLES))
    torque = 0.1 * np.gradient(rate, INTERVAL) + 3.0 * np.sign(rate) + 0.5 * rate + 0.02 * rng.standard_normal(SAMPLES)
    channels = {"time": time, "torque": torque, "velocity": velocity, "position": seen}
    return Recording("drive", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


@pytest.mark.parametrize("times", [0.94, 0.98, 1.02, 1.08])
@pytest.mark.parametrize(
    "sensors", [{}, {"counts": 2**11}, {"noise": 0.2}, {"smoothing": 0.1}, {"counts": 2**10, "smoothing": 0.5}]
)
def test_another_scale_is_told_whatever_the_sensors_do_besides(times: float, sensors: dict[str, float]) -> None:
    recording = logged(times, **sensors)
    found = velocity_scale(recording)
    assert found is not None
    assert found.is_another
    assert found.value == pytest.approx(times, abs=4.0 * found.error)
    (said,) = [finding for finding in findings(recording) if finding.kind == "velocity-scale"]
    assert said.severity is Severity.WARN
    assert "another scale" in said.text


@pytest.mark.parametrize(
    "sensors",
    [{}, {"counts": 2**9}, {"noise": 0.5}, {"smoothing": 0.03}, {"counts": 2**11, "smoothing": 0.1}, {"scale": 1.004}],
)
def test_a_right_scale_is_not_accused(sensors: dict[str, float]) -> None:
    recording = logged(**sensors)
    assert other_scale(recording) == 1.0
    assert "velocity-scale" not in {finding.kind for finding in findings(recording)}


def test_a_velocity_that_was_filtered_without_a_lag_has_its_scale() -> None:
    recording = logged()
    even = np.ones(101) / 101
    smooth = recording.with_channels(derived=False, velocity=filtfilt(even, [1.0], recording.velocity))
    assert np.std(smooth.velocity) < 0.99 * np.std(recording.velocity)
    assert other_scale(smooth) == 1.0


def test_stamps_that_wander_are_no_scale() -> None:
    recording = logged()
    late = INTERVAL * np.random.default_rng(1).uniform(-0.3, 0.3, SAMPLES)
    found = velocity_scale(recording.with_channels(derived=False, time=recording.time + late))
    assert found is not None
    assert found.value == pytest.approx(1.0, abs=max(1e-3, 4.0 * found.error))


@pytest.mark.parametrize("counts", [2**10, 2**16])
def test_fits_take_the_scale_of_the_position(counts: int) -> None:
    right, wrong = ready(logged(counts=counts)), ready(logged(1.06, counts=counts))
    size = float(right.velocity @ right.velocity)
    assert float(wrong.velocity @ right.velocity) / size == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize(("unit", "expected"), [("deg", "1.05 deg"), ("2 deg", "2.1 deg"), ("count/4096", "")])
def test_the_way_to_go_on_with_the_velocity_is_an_option_that_is_read(unit: str, expected: str) -> None:
    recording = replace(logged(1.05, noise=0.0), provenance={"columns": {"position": f"position=q:{unit}"}})
    (said,) = [finding for finding in findings(recording) if finding.kind == "velocity-scale"]
    given = shlex.split(said.remedy)[-1].partition("q:")[2]
    assert expected in given
    factors = [units.conversion(text, "position", Motion.ROTARY).factor for text in (given, unit)]
    assert factors[0] / factors[1] == pytest.approx(1.05, abs=1e-3)


def test_a_short_log_of_a_noisy_position_is_not_said_to_be_of_another_motion() -> None:
    """Two seconds at 100 Hz: from sample to sample, and over four, the position changes by its noise."""
    rng, time = np.random.default_rng(0), 0.01 * np.arange(201)
    angle = 2 * np.pi * time
    channels = {
        "time": time,
        "torque": 0.02 * np.cos(angle + 0.4) + 1e-4 * rng.standard_normal(201),
        "velocity": 0.06 * np.sin(angle) + 1e-3 * rng.standard_normal(201),
        "position": -0.06 / (2 * np.pi) * np.cos(angle) + 2.5e-3 * rng.standard_normal(201),
    }
    recording = Recording("short", Motion.ROTARY, channels, np.zeros(201, dtype=np.int64))
    assert "velocity-scale" not in {found.kind for found in findings(recording)}
    other = recording.with_channels(derived=False, position=np.cos(3.3 * angle))
    assert "velocity-scale" in {found.kind for found in findings(other)}, "another motion is still told"
