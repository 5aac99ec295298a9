"""Time stamps in whole seconds and nanoseconds, as ROS writes them, are one time."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import read

BEGUN = 1_700_000_000
MAPPED = ("torque=effort:N*m", "velocity=velocity:rad/s")


def rows(count: int = 900) -> list[tuple[int, int, float, float]]:
    stamps = 997_000_000 + 2_000_000 * np.arange(count)
    velocity = np.cos(0.05 * np.arange(count))
    effort = 0.3 * np.sign(velocity) + 0.1 * velocity
    return [
        (BEGUN + int(t // 10**9), int(t % 10**9), float(v), float(u))
        for t, v, u in zip(stamps, velocity, effort, strict=True)
    ]


@pytest.mark.parametrize(("whole", "part"), [("secs", "nsecs"), ("sec", "nanosec")])
def test_messages_and_tables(whole: str, part: str, tmp_path: Path) -> None:
    messages = [{"header": {"stamp": {whole: s, part: n}}, "velocity": [v], "effort": [u]} for s, n, v, u in rows()]
    (tmp_path / "log.json").write_text(json.dumps(messages))
    lines = [
        f"header.stamp.{whole},header.stamp.{part},velocity,effort",
        *(f"{s},{n},{v},{u}" for s, n, v, u in rows()),
    ]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    for name in ("log.json", "log.csv"):
        found = read(tmp_path / name, columns=["time=header.stamp", *MAPPED])
        np.testing.assert_allclose(np.diff(found.time), 2e-3, rtol=1e-9)
        with pytest.raises(InputError, match=r"--column time=header\.stamp\[:UNIT\]"):
            read(tmp_path / name, columns=MAPPED)


def test_a_table_that_has_such_a_column_keeps_it(tmp_path: Path) -> None:
    lines = [
        "stamp,stamp.secs,stamp.nsecs,velocity,effort",
        *(f"{i},{s},{n},{v},{u}" for i, (s, n, v, u) in enumerate(rows())),
    ]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    assert read(tmp_path / "log.csv", columns=["time=stamp:ms", *MAPPED]).interval == pytest.approx(1e-3)


def test_a_parquet_file(tmp_path: Path) -> None:
    pd = pytest.importorskip("pandas")
    table = pd.DataFrame(rows(), columns=["stamp.sec", "stamp.nanosec", "velocity", "effort"])
    table.to_parquet(tmp_path / "log.parquet")
    found = read(tmp_path / "log.parquet", columns=["time=stamp", *MAPPED])
    np.testing.assert_allclose(np.diff(found.time), 2e-3, rtol=1e-9)
