"""Stamps with the day or the month first."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import read

SAMPLES = 300
MIDNIGHT = datetime(2025, 3, 3, 23, 59, 59)
NOON = datetime(2025, 3, 3, 12, 0, 0)


def written(path: Path, how: str, start: datetime, name: str = "stamp", delimiter: str = ";", cut: int = 3) -> Path:
    """Write a log of 250 samples a second whose time is a stamp, of so many digits less than microseconds."""
    rows = [f"{name}{delimiter}torque_Nm{delimiter}velocity_rad_s"]
    for i in range(SAMPLES):
        stamp = (start + timedelta(milliseconds=4 * i)).strftime(how)
        stamp = stamp[:-cut] if how.endswith("%f") else stamp
        rows.append(f"{stamp}{delimiter}{np.cos(i / 9):.4f}{delimiter}{np.sin(i / 9):.4f}")
    path.write_text("\n".join(rows))
    return path


@pytest.mark.parametrize(
    ("how", "start", "name"),
    [
        ("%d.%m.%Y %H:%M:%S.%f", MIDNIGHT, "stamp"),
        ("%d.%m.%Y %H:%M:%S,%f", MIDNIGHT, "Datum/Zeit"),
        ("%d.%m.%Y, %H:%M:%S.%f", MIDNIGHT, "stamp"),
        ("%d/%m/%Y %H:%M:%S.%f", MIDNIGHT.replace(day=30), "stamp"),
        ("%m/%d/%Y %H:%M:%S.%f", MIDNIGHT.replace(day=30), "stamp"),
        ("%d/%m/%Y %H:%M:%S.%f", MIDNIGHT, "stamp [dd/mm/yyyy]"),
        ("%m-%d-%Y %H:%M:%S.%f", MIDNIGHT, "stamp (MM-DD-YYYY hh:mm:ss)"),
        ("%d/%m/%Y %H:%M:%S.%f", NOON, "stamp"),
        ("%Y-%m-%d %H:%M:%S.%f", MIDNIGHT, "stamp"),
    ],
)
def test_a_date_that_can_be_read_in_one_way_is_read(tmp_path: Path, how: str, start: datetime, name: str) -> None:
    recording = read(written(tmp_path / "log.csv", how, start, name), columns=[f"time={name}"])
    np.testing.assert_allclose(recording.time, 0.004 * np.arange(SAMPLES), atol=1e-9)


def test_the_halves_of_a_day_are_told(tmp_path: Path) -> None:
    path = written(tmp_path / "log.csv", "%m/%d/%Y %I:%M:%S.%f", datetime(2025, 3, 30, 11, 59, 59))
    lines = path.read_text().splitlines()
    halves = [line.replace(";", f" {'AM' if ' 11:' in line else 'PM'};", 1) for line in lines[1:]]
    path.write_text("\n".join([lines[0], *halves]))
    np.testing.assert_allclose(read(path, columns=["time=stamp"]).time, 0.004 * np.arange(SAMPLES), atol=1e-9)


@pytest.mark.parametrize("how", ["%d/%m/%Y %H:%M:%S.%f", "%d-%m-%Y %H:%M:%S.%f"])
def test_a_date_that_may_be_read_in_two_ways_is_refused(tmp_path: Path, how: str) -> None:
    path = written(tmp_path / "log.csv", how, MIDNIGHT)
    with pytest.raises(InputError, match=r"in one way only.*\[dd/mm/yyyy\].*time=row"):
        read(path, columns=["time=stamp"])


@pytest.mark.parametrize("stamp", ["31.02.2025 10:00:00", "01.13.2025 10:00:00", "01.05.2025 25:00:00"])
def test_a_date_that_does_not_exist_is_refused(tmp_path: Path, stamp: str) -> None:
    path = written(tmp_path / "log.csv", "%d.%m.%Y %H:%M:%S.%f", NOON)
    path.write_text(path.read_text().replace("03.03.2025 12:00:00.000", stamp))
    with pytest.raises(InputError, match="date and time"):
        read(path, columns=["time=stamp"])
