"""A Parquet column of any kind of Arrow: numbers, or one line that names the column."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import read
from fricmodels.readers.blocks import blocks

TIME = 0.01 * np.arange(300)
COSINE = np.cos(TIME)


def written(folder: Path, **columns: Any) -> Path:
    """Write a motion with other columns in the place of its own, or beside them."""
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    own = {"time_s": TIME, "torque_Nm": np.sin(TIME), "velocity_rad_s": COSINE}
    parquet.write_table(pa.table({**own, **columns}), folder / "log.parquet")
    return folder / "log.parquet"


@pytest.mark.parametrize(
    "velocity",
    [
        [Decimal(f"{value:.12f}") for value in COSINE],
        COSINE.astype(np.float32),
        [f"{value:.12f}" for value in COSINE],
    ],
    ids=["decimal", "single", "text"],
)
def test_numbers_of_other_kinds_are_numbers(tmp_path: Path, velocity: Any) -> None:
    assert read(written(tmp_path, velocity_rad_s=velocity)).velocity == pytest.approx(COSINE, abs=1e-6)


@pytest.mark.parametrize(
    ("column", "values", "message"),
    [
        ("time_s", [b"\xff"] * 300, "row 1, column 'time_s': .* is not a number"),
        ("velocity_rad_s", [b"\xff"] * 300, "row 1, column 'velocity_rad_s': .* is not a number"),
        ("velocity_rad_s", [[1.0]] * 300, "row 1, column 'velocity_rad_s': .* is not a number"),
        ("velocity_rad_s", [{"a": 1}] * 300, "row 1, column 'velocity_rad_s': .* is not a number"),
        ("velocity_rad_s", pd.date_range("2026-01-01", periods=300, tz="UTC"), r"'velocity_rad_s' .*holds dates"),
        ("velocity_rad_s", pd.to_timedelta(TIME, unit="s"), r"'velocity_rad_s' .*holds dates or times"),
    ],
)
def test_what_is_no_number_is_one_line(tmp_path: Path, column: str, values: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(written(tmp_path, **{column: values}))


def test_runs_may_be_named_by_bytes(tmp_path: Path) -> None:
    recording = read(written(tmp_path, run=[b"\xff"] * 150 + [b"\xfe"] * 150))
    assert list(np.bincount(recording.run)) == [150, 150]


def test_blocks_take_the_names_above_stated_units_as_reading_does(tmp_path: Path) -> None:
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    table = pa.table({"Time": 1000.0 * TIME, "Torque": np.sin(TIME), "Speed": 60.0 * COSINE})
    stated = {"Time": b"ms", "Torque": b"mN*m", "Speed": b"rpm"}
    fields = [field.with_metadata({b"unit": stated[field.name]}) for field in table.schema]
    path = tmp_path / "log.parquet"
    parquet.write_table(table.cast(pa.schema(fields)), path)
    whole, (block,) = read(path), blocks(path).of(["time", "torque", "velocity"])
    for channel in ("time", "torque", "velocity"):
        np.testing.assert_allclose(block.channels[channel], whole[channel], rtol=1e-12)
    assert whole.velocity.max() == pytest.approx(2 * np.pi, rel=1e-3)
