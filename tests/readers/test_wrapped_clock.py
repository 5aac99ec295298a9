"""A clock that begins anew where its counter is full goes on; one that begins anew elsewhere is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.logcheck import findings
from fricmodels.readers import read
from fricmodels.readers.wrapped_clock import going_on

STEP = 1e-3


def write(path: Path, stamps: np.ndarray, unit: str) -> Path:
    """Write a drive that was sampled at 1 kHz, with the stamps that its logger wrote."""
    time = STEP * np.arange(len(stamps))
    velocity = 3.0 * np.sin(4.0 * time) + np.sin(11.0 * time)
    torque = 0.01 * (12.0 * np.cos(4.0 * time) + 11.0 * np.cos(11.0 * time)) + 0.2 * np.sign(velocity)
    head = f"Time [{unit}],Velocity [rad/s],Torque [Nm]"
    rows = (f"{t:.12g},{v:.6f},{m:.6f}" for t, v, m in zip(stamps, velocity, torque, strict=True))
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


CLOCKS = {
    "milliseconds in 16 bits": ("ms", 1000.0, 2.0**16, 0.0, 65_000.0),
    "microseconds in 32 bits": ("us", 1e6, 2.0**32, 0.0, 2.0**32 - 2e6),
    "with a sign": ("us", 1e6, 2.0**32, -(2.0**31), 2.0**31 - 2e6),
    "written in seconds": ("s", 1.0, 2.0**32 * 1e-6, 0.0, 4293.0),
    "seconds of the day": ("s", 1.0, 86_400.0, 0.0, 86_398.5),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_a_clock_goes_on_where_its_counter_is_full(name: str, tmp_path: Path) -> None:
    unit, per_second, period, begin, first = CLOCKS[name]
    counted = first + per_second * STEP * np.arange(5000)
    recording = read(write(tmp_path / "log.csv", (counted - begin) % period + begin, unit))
    np.testing.assert_allclose(np.diff(recording.time), STEP, rtol=1e-3)
    assert recording.provenance["clock_period"] == pytest.approx(period, rel=1e-12)
    (found,) = [finding for finding in findings(recording) if finding.kind == "wrapped-clock"]
    assert f"{period:.12g}" in found.text


def test_every_wrap_counts(tmp_path: Path) -> None:
    counted = 60_000.0 + np.arange(140_000.0)
    recording = read(write(tmp_path / "log.csv", counted % 65_536.0, "ms"))
    assert recording.time[-1] - recording.time[0] == pytest.approx(139.999)


@pytest.mark.parametrize(("last", "first"), [(60_000, 0), (65_535, 300), (65_000, 0)])
def test_a_clock_that_begins_anew_elsewhere_is_refused(last: int, first: int, tmp_path: Path) -> None:
    stamps = np.concatenate([np.arange(last - 2000.0, last + 1.0), first + np.arange(2000.0)])
    with pytest.raises(InputError, match="the time goes back"):
        read(write(tmp_path / "log.csv", stamps, "ms"))


def test_each_run_counts_its_own_wraps() -> None:
    time = np.array([65_534.0, 65_535.0, 0.0, 1.0, 5.0, 6.0, 7.0])
    found, period = going_on(time, np.array([0, 0, 0, 0, 1, 1, 1]))
    assert period == 65_536.0
    np.testing.assert_array_equal(found, [65_534.0, 65_535.0, 65_536.0, 65_537.0, 5.0, 6.0, 7.0])


def test_a_run_begins_anew_and_nothing_goes_on(tmp_path: Path) -> None:
    stamps = np.tile(np.arange(63_000.0, 65_536.0), 2)
    path = write(tmp_path / "log.csv", stamps, "ms")
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    both = [head + ",run", *(f"{row},{i // 2536}" for i, row in enumerate(rows))]
    path.write_text("\n".join(both) + "\n", encoding="utf-8")
    recording = read(path)
    assert "clock_period" not in recording.provenance
    np.testing.assert_array_equal(recording.time[:2536], recording.time[2536:])
