"""Files that are spoilt, hostile or no files: one line with the place, soon, and without much memory."""

from __future__ import annotations

import io
import os
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io

from fricmodels.errors import InputError
from fricmodels.readers import apart, read
from fricmodels.readers.base import Reader
from fricmodels.readers.matlab import MatlabReader

SAMPLES = 400


def motion(**scales: float) -> pd.DataFrame:
    time_s = 0.01 * np.arange(SAMPLES)
    velocity = np.sin(2 * np.pi * time_s)
    columns = {"time_s": time_s, "torque_Nm": 0.1 * velocity + 0.2 * np.sign(velocity), "velocity_rad_s": velocity}
    return pd.DataFrame({name: values * scales.get(name, 1.0) for name, values in columns.items()})


TEXT = motion().to_csv(index=False)
LONG = TEXT + TEXT.partition("\n")[2] * 10
TEXTS: dict[str, tuple[bytes | str, str]] = {
    "long field": (TEXT.replace("\n0.02,", "\n" + "x" * 200_000 + ","), "line 4, column 'time_s': 'xxxx"),
    "long name": (TEXT.replace("torque_Nm", "x" * 200_000), "no column for the torque or current"),
    "long line": (TEXT.replace("torque_Nm", "x" * 2_000_000), "line 1 has 20000"),
    "many columns": (",".join(f"c{i}" for i in range(20_000)) + "\n1\n", "line 1 names 20000 columns, more than 10000"),
    "UTF-8 that breaks late": (LONG.encode()[:70_000] + b"\xff\xfe\n" + TEXT.encode(), "is no UTF-8; repair that line"),
    "UTF-16 that ends within a letter": (TEXT.encode("utf-16")[:-1], "line 401 is no UTF-16"),
    "UTF-16 that breaks": (
        TEXT.encode("utf-16")[:200] + b"\x00\xd8A\x00" + TEXT.encode("utf-16")[200:],
        "is no UTF-16; repair that line",
    ),
    "number of 400 digits": (
        TEXT.replace("\n0.02,", "\n" + "1" * 400 + ","),
        "line 4, time (time=time_s): an infinite",
    ),
    "unit without end": (TEXT.replace("rad_s\n", "rad_s\n10**10**8*s,N*m,rad/s\n", 1), "unknown unit '10**10**8*s'"),
    "quote without end": (TEXT.replace("\n0.02,", '\n"0.02,'), "cannot be read as a table"),
}


@pytest.mark.parametrize("case", TEXTS)
def test_spoilt_text(case: str, tmp_path: Path) -> None:
    content, expected = TEXTS[case]
    path = tmp_path / "log.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError) as refused:
        read(path)
    assert expected in str(refused.value)
    assert str(path) in str(refused.value)


@pytest.mark.parametrize(
    ("column", "scale"),
    [("torque_Nm", 1e200), ("torque_Nm", 1e-200), ("velocity_rad_s", 1e300), ("time_s", 1e300), ("time_s", 1e-310)],
)
def test_numbers_without_a_square_are_refused(column: str, scale: float, tmp_path: Path) -> None:
    motion(**{column: scale}).to_csv(tmp_path / "log.csv", index=False)
    with pytest.raises(InputError, match="correct its unit") as refused:
        read(tmp_path / "log.csv")
    assert column.partition("_")[0] in str(refused.value)


def test_a_run_number_beyond_whole_numbers_is_a_name(tmp_path: Path) -> None:
    motion().assign(run=1e300).to_csv(tmp_path / "log.csv", index=False)
    assert read(tmp_path / "log.csv").provenance["runs"] == {0: "1e+300"}


@pytest.mark.parametrize("suffix", ["csv", "parquet", "mat"])
def test_a_pipe_and_a_device_are_not_waited_for(suffix: str, tmp_path: Path) -> None:
    pipe, zeros = tmp_path / f"pipe.{suffix}", tmp_path / f"zeros.{suffix}"
    os.mkfifo(pipe)
    zeros.symlink_to("/dev/zero")
    for path in (pipe, zeros):
        with pytest.raises(InputError, match="is a device or a pipe, no file"):
            read(path)


TICKS = (motion()["time_s"] * 1e9).round().astype("int64")
TIMES: dict[str, Callable[[], Any]] = {
    "time of day in ns": lambda: pa.array(TICKS, pa.time64("ns")),
    "time of day in us": lambda: pa.array(TICKS // 1000, pa.time64("us")),
    "time of day in ms": lambda: pa.array((TICKS // 10**6).astype("int32"), pa.time32("ms")),
    "duration": lambda: pa.array(TICKS, pa.duration("ns")),
    "instant": lambda: pa.array(TICKS, pa.timestamp("ns")),
}


@pytest.mark.parametrize("case", TIMES)
def test_every_kind_of_time_in_parquet_is_seconds(case: str, tmp_path: Path) -> None:
    columns = {name: pa.array(values) for name, values in motion().items()} | {"time_s": TIMES[case]()}
    pq.write_table(pa.table(columns), tmp_path / "log.parquet")
    np.testing.assert_allclose(read(tmp_path / "log.parquet").time, motion()["time_s"], atol=2e-9)


def test_a_unit_that_is_no_text_is_unknown(tmp_path: Path) -> None:
    table = pa.table({name: pa.array(values) for name, values in motion().items()})
    fields = [pa.field(name, pa.float64(), metadata={"unit": b"\xff\xfe"}) for name in table.column_names]
    pq.write_table(table.cast(pa.schema(fields)), tmp_path / "log.parquet")
    with pytest.raises(InputError, match="unknown unit"):
        read(tmp_path / "log.parquet")


def test_small_files_that_unpack_to_gigabytes_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "_LEAST_MEMORY", 200_000_000)
    rows = 9_000_000
    column = pa.array(np.zeros(rows))
    pq.write_table(
        pa.table({"time_s": column, "torque_Nm": column, "velocity_rad_s": column}), tmp_path / "zero.parquet"
    )
    del column
    scipy.io.savemat(tmp_path / "zero.mat", {"a": np.zeros(4 * 10**7)}, do_compression=True)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match=r"unpack to 0.216 GB, over 100 times the file"):
        read(tmp_path / "zero.parquet")
    with pytest.raises(InputError, match="unpacks to more memory than a recording of its size needs"):
        read(tmp_path / "zero.mat")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 100_000


class Deadly(Reader):
    """Does not come back from its file."""

    name = "deadly"
    suffixes = (".dead",)
    apart = True

    def table(self, path: Path) -> pd.DataFrame:
        what = path.read_text()
        if what == "loop":
            while True:
                pass
        if what == "die":
            os.abort()
        if what == "exit":
            os._exit(0)
        if what == "print":
            print("noise")
            raise ZeroDivisionError("seven by nothing")
        frame = pd.DataFrame([[1.0, 2.0, "x"]], columns=["a", "a", "b"])
        frame.attrs["units"] = {"a": "m"}
        return frame


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("loop", "takes longer than 3 s (FRICMODELS_READ_TIMEOUT sets the limit)"),
        ("die", "damaged: reading it kills its reader (SIGABRT)"),
        ("exit", "damaged: reading it kills its reader (exit code 0)"),
        ("print", "cannot be read: seven by nothing"),
    ],
)
def test_a_reader_that_does_not_come_back_is_an_error(
    what: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    importable(tmp_path, monkeypatch)
    monkeypatch.setenv(apart.LIMIT, "3" if what == "loop" else "60")  # to start a process takes a while
    path = tmp_path / "x.dead"
    path.write_text(what)
    with pytest.raises(InputError) as refused:
        apart.table_apart(Deadly(), path)
    assert message in str(refused.value)
    assert capfd.readouterr().out == ""


def test_a_table_comes_back_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    importable(tmp_path, monkeypatch)
    (tmp_path / "x.dead").write_text("table")
    table = apart.table_apart(Deadly(), tmp_path / "x.dead")
    assert list(table.columns) == ["a", "a", "b"]
    assert table.to_numpy().tolist() == [[1.0, 2.0, "x"]]
    assert table.attrs["units"] == {"a": "m"}


def importable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a child import this file by a name of its own."""
    (tmp_path / "spoilt_files_apart.py").write_text(Path(__file__).read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(Deadly, "__module__", "spoilt_files_apart")


@pytest.mark.parametrize("limit", ["soon", "0", "-1", "nan"])
def test_a_limit_that_is_none_is_refused(limit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(apart.LIMIT, limit)
    with pytest.raises(InputError, match=f"FRICMODELS_READ_TIMEOUT is '{limit}'"):
        apart.table_apart(Deadly(), Path("x.dead"))


def test_matlab_files_of_the_other_byte_order_come_back(tmp_path: Path) -> None:
    stream = io.BytesIO()
    scipy.io.savemat(stream, {name: values.to_numpy() for name, values in motion().items()})
    (tmp_path / "log.mat").write_bytes(stream.getvalue())
    table = apart.table_apart(MatlabReader(), tmp_path / "log.mat")
    np.testing.assert_array_equal(table["torque_Nm"], motion()["torque_Nm"])
    values = pd.DataFrame({"a": np.arange(3, dtype=">f8")})
    apart._write(values, tmp_path / "out")
    assert apart._taken(tmp_path / "log.mat", tmp_path / "out", 0)["a"].tolist() == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("joints", [2, 3])
def test_rows_of_several_joints_at_each_time_are_told(tmp_path: Path, joints: int) -> None:
    """A table of joint states holds a row of each joint at each stamp: no clock that is coarser than the samples."""
    rows = ((0.01 * i, j, 0.03 * (i + 60 * j)) for i in range(200) for j in range(joints))
    lines = [f"{time:.2f},joint{j},{np.sin(phase) + j:.6f},{np.cos(phase):.6f}" for time, j, phase in rows]
    lines.insert(0, "time_s,name,position_rad,torque_Nm")
    path = tmp_path / "states.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=f"rows of {joints} things, as of {joints} joints; write the rows of one"):
        read(path)
