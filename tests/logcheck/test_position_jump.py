"""A position that jumps within one sample, and much that only looks so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.logcheck import Severity, findings
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.signals.jumps import find_jumps, mend_jumps

INTERVAL, SAMPLES = 2e-3, 6000
AT = 2500


def logged(counts: int = 2**14, *, measured: bool = True, interval: float = INTERVAL) -> Recording:
    """Return a drive that goes back and forth, with rests; with a velocity of its own where that is ``measured``."""
    rng = np.random.default_rng(0)
    time = interval * np.arange(float(SAMPLES))
    rate = np.where(np.sin(0.9 * time) > -0.5, np.sin(2.0 * time) + 0.6 * np.sin(5.3 * time), 0.0)
    position = np.cumsum(rate) * interval
    seen = np.round(position * counts / (2 * np.pi)) * 2 * np.pi / counts
    channels: dict[str, Array] = {
        "time": time,
        "torque": 4.0 * np.sign(rate) + 0.1 * rng.standard_normal(SAMPLES),
        "position": seen,
    }
    if measured:
        channels["velocity"] = rate + 0.01 * rng.standard_normal(SAMPLES)
    return Recording("drive", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


def with_position(recording: Recording, position: np.ndarray) -> Recording:
    return recording.with_channels(derived=False, position=position)


def jumped(recording: Recording, size: float, at: int = AT) -> Recording:
    later = np.arange(SAMPLES) > at
    return with_position(recording, recording["position"] + np.where(later, size, 0.0))


@pytest.mark.parametrize("measured", [True, False])
@pytest.mark.parametrize("size", [0.05, -0.3])
def test_a_jump_is_told_with_its_time_and_size(measured: bool, size: float) -> None:
    recording = jumped(logged(measured=measured), size)
    found = find_jumps(recording)
    assert found is not None
    assert found.after.tolist() == [AT]
    assert found.size[0] == pytest.approx(size, abs=1e-3)
    (said,) = [finding for finding in findings(recording) if finding.kind == "position-jump"]
    assert said.severity is Severity.WARN
    assert "after 5 s" in said.text


def test_beside_a_velocity_the_position_is_put_together_and_the_longest_part_stays() -> None:
    clean = logged()
    spoilt = jumped(jumped(clean, 0.3), -0.1, 5000)
    mended = mend_jumps(spoilt)
    assert np.array(mended.provenance["jumps"]) == pytest.approx(np.array([[5.0, 0.3], [10.0, -0.1]]), abs=1e-3)
    apart = mended["position"] - clean["position"]
    assert np.ptp(apart) < 3e-3
    assert np.array_equal(mended["position"][: AT + 1], spoilt["position"][: AT + 1])
    assert "put together" in next(finding.text for finding in findings(mended) if finding.kind == "position-jump")
    bare = logged(measured=False)
    assert "jumps" not in mend_jumps(jumped(bare, 0.3)).provenance, "without a velocity it may have moved"


def test_each_run_is_put_together_by_itself() -> None:
    clean = logged()
    run = (np.arange(SAMPLES) >= 4000).astype(np.int64)
    offset = np.where(run == 1, 5.0, 0.0)
    recording = replace(with_position(clean, clean["position"] + offset), run=run)
    assert find_jumps(recording) is None
    later = (np.arange(SAMPLES) > AT) & (run == 0)
    mended = mend_jumps(with_position(recording, recording["position"] + np.where(later, 0.2, 0.0)))
    assert np.ptp((mended["position"] - recording["position"])[run == 0]) < 2e-3
    assert np.array_equal(mended["position"][run == 1], recording["position"][run == 1])


def spiked(recording: Recording) -> Recording:
    return with_position(recording, recording["position"] + np.where(np.arange(SAMPLES) == AT, 0.4, 0.0))


def lost(recording: Recording) -> Recording:
    return recording.select(np.delete(np.arange(SAMPLES), np.arange(AT, AT + 40)))


def jittered(recording: Recording) -> Recording:
    late = INTERVAL * np.random.default_rng(1).uniform(-0.45, 0.45, SAMPLES)
    return recording.with_channels(derived=False, time=np.asarray(recording.time + late))


def one_lost_unseen(recording: Recording) -> Recording:
    some = recording.select(np.delete(np.arange(SAMPLES), AT))
    return some.with_channels(derived=False, time=recording.time[:-1])


def seldom(recording: Recording) -> Recording:
    return recording.select(np.arange(0, SAMPLES, 40))


def still(recording: Recording) -> Recording:
    step = 2 * np.pi / 2**14
    return with_position(recording, np.where(np.arange(SAMPLES) > AT, step, 0.0))


@pytest.mark.parametrize("measured", [True, False])
@pytest.mark.parametrize("change", [lambda same: same, spiked, lost, jittered, one_lost_unseen, seldom, still])
@pytest.mark.parametrize("counts", [2**8, 2**14, 2**24])
def test_what_is_no_jump_is_not_called_one(
    measured: bool, change: Callable[[Recording], Recording], counts: int
) -> None:
    recording = change(logged(counts, measured=measured))
    assert find_jumps(recording) is None
    assert mend_jumps(recording) is recording


def test_a_file_is_read_with_its_position_put_together(tmp_path: Path) -> None:
    recording = jumped(logged(), 0.3)
    table = np.stack([recording[name] for name in ("time", "torque", "velocity", "position")], axis=1)
    path = tmp_path / "log.csv"
    np.savetxt(path, table, delimiter=",", header="time_s,torque_Nm,velocity_rad_s,position_rad", comments="")
    known = read(path).provenance["jumps"]
    assert known == [[pytest.approx(5.0), pytest.approx(0.3, abs=1e-3)]]
