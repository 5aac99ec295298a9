"""HDF5 files and MATLAB's of version 7.3: groups, structures, transposed arrays, chunks, faults."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import hdf5, read
from fricmodels.readers.matlab import MatlabReader

h5py = pytest.importorskip("h5py", reason="h5py is not installed")

SAMPLES = 300
TIME = 0.01 * np.arange(SAMPLES)
VELOCITY = np.sin(2 * np.pi * TIME)
CHANNELS = {"time_s": TIME, "torque_Nm": 0.1 * VELOCITY + 0.2 * np.sign(VELOCITY), "velocity_rad_s": VELOCITY}


@pytest.fixture(autouse=True)
def here(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read in this process, which is sooner, but where a test is about the other one."""
    if "apart" not in request.node.name:
        for reader in (hdf5.Hdf5Reader, MatlabReader):
            monkeypatch.setattr(reader, "apart", False)


def made(path: Path, write: Callable[[Any], object], **how: Any) -> Path:
    with h5py.File(path, "w", **how) as file:
        write(file)
    return path


def put(group: Any, channels: dict[str, Any] = CHANNELS, **how: Any) -> None:
    for name, values in channels.items():
        group.create_dataset(name, data=values, **how)


def same(path: Path, *mapped: str, **how: Any) -> Any:
    recording = read(path, columns=mapped, **how)
    np.testing.assert_array_equal(recording.velocity, VELOCITY)
    np.testing.assert_array_equal(recording.torque, CHANNELS["torque_Nm"])
    return recording


STORED: dict[str, dict[str, Any]] = {
    "plain": {},
    "chunks": {"chunks": (64,)},
    "gzip, shuffled": {"chunks": (64,), "compression": "gzip", "shuffle": True},
    "lzf": {"compression": "lzf"},
    "big endian": {"dtype": ">f8"},
    "checksum": {"fletcher32": True},
    "room to grow": {"maxshape": (None,)},
}


@pytest.mark.parametrize("how", STORED)
def test_however_it_is_stored(how: str, tmp_path: Path) -> None:
    same(made(tmp_path / "log.h5", lambda file: put(file, **STORED[how])))


def test_apart_from_this_process(tmp_path: Path) -> None:
    same(made(tmp_path / "log.h5", lambda file: put(file.create_group("log"))))
    path = matlab(tmp_path / "log.mat", lambda file: [matlab_array(file, *each) for each in CHANNELS.items()])
    same(path, "velocity=velocity_rad_s:rad/s")


def test_the_one_group_of_a_file_needs_no_path(tmp_path: Path) -> None:
    path = made(tmp_path / "log.h5", lambda file: put(file.create_group("logs/joint 2")))
    same(path)
    same(path, "velocity=/logs/joint 2/velocity_rad_s", "time=/logs/joint 2/time_s", "torque=/logs/joint 2/torque_Nm")


def test_columns_of_one_group_are_chosen_by_path(tmp_path: Path) -> None:
    def write(file: Any) -> None:
        put(file.create_group("run1"))
        for number in (2, 3):  # most vectors are of another length
            put(file.create_group(f"run{number}"), {name: values[:200] for name, values in CHANNELS.items()})

    path = made(tmp_path / "log.hdf5", write)
    same(path, "time=/run1/time_s", "velocity=/run1/velocity_rad_s", "torque=/run1/torque_Nm")
    with pytest.raises(InputError, match=r"no column for the time.*--column time=/run2/time_s"):
        read(path)


def test_groups_are_runs_where_that_is_asked_for(tmp_path: Path) -> None:
    def write(file: Any) -> None:
        put(file.create_group("monday"))
        put(file.create_group("tuesday"), {name: 2 * values[:200] for name, values in CHANNELS.items()})
        put(file.create_group("about"), {"version": np.arange(3)})

    recording = read(made(tmp_path / "log.h5", write), columns=["run=group"])
    assert recording.provenance["runs"] == {0: "monday", 1: "tuesday"}
    assert np.bincount(recording.run).tolist() == [SAMPLES, 200]
    np.testing.assert_array_equal(recording.velocity[SAMPLES:], 2 * VELOCITY[:200])


def test_units_matrices_and_compound_types(tmp_path: Path) -> None:
    def write(file: Any) -> None:
        file["t"] = 1000 * TIME
        file["t"].attrs["units"] = "ms"
        file["joints"] = np.degrees(np.column_stack([VELOCITY, 0 * VELOCITY]))
        file["joints"].attrs["unit"] = np.bytes_(b"deg/s")
        fields = np.zeros(SAMPLES, dtype=[("effort", "<f4"), ("name", "S3")])
        fields["effort"] = CHANNELS["torque_Nm"]
        file["state"] = fields

    path = made(tmp_path / "log.h5", write)
    recording = read(path, columns=["time=t", "velocity=joints(1)", "torque=state.effort"])
    np.testing.assert_allclose(recording.velocity, VELOCITY, atol=1e-12)
    np.testing.assert_allclose(recording.time, TIME, rtol=1e-12)
    np.testing.assert_allclose(recording.torque, CHANNELS["torque_Nm"], rtol=1e-6)


def test_dates_as_text(tmp_path: Path) -> None:
    stamps = [f"2026-11-22T10:00:{second:09.6f}" for second in TIME]

    def write(file: Any) -> None:
        put(file, {name: values for name, values in CHANNELS.items() if name != "time_s"})
        file["stamp"] = stamps

    np.testing.assert_allclose(same(made(tmp_path / "log.h5", write), "time=stamp").time, TIME, atol=1e-9)


def matlab_array(group: Any, name: str, values: Any, kind: str = "double") -> Any:
    """Write an array as MATLAB does: with its axes in the other order, and its class beside it."""
    group.create_dataset(name, data=np.atleast_2d(values).T if np.ndim(values) == 2 else np.atleast_2d(values))
    group[name].attrs["MATLAB_class"] = np.bytes_(kind.encode())
    return group[name]


def matlab(path: Path, write: Callable[[Any], object]) -> Path:
    made(path, write, userblock_size=512)
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + b"\0" * 8 + b"\x00\x02IM")
    return path


def test_matlab_vectors(tmp_path: Path) -> None:
    def write(file: Any) -> None:
        for name, values in CHANNELS.items():
            matlab_array(file, name, values[:, None] if name == "time_s" else values)  # a column, and rows
        matlab_array(file, "gear", np.array([[50.0]]))
        matlab_array(file, "note", np.frombuffer("measured".encode("utf-16-le"), dtype="<u2"), "char")

    same(matlab(tmp_path / "log.mat", write))


def test_matlab_structures_matrices_and_cells(tmp_path: Path) -> None:
    stamps = [f"2026-11-22T10:00:{second:09.6f}" for second in TIME]

    def write(file: Any) -> None:
        joint = file.create_group("log").create_group("joint2")
        joint.attrs["MATLAB_class"] = np.bytes_(b"struct")
        matlab_array(joint, "q", np.column_stack([VELOCITY, 0 * VELOCITY]))
        matlab_array(joint, "tau", CHANNELS["torque_Nm"])
        texts = file.create_group("#refs#")
        for number, stamp in enumerate(stamps):
            matlab_array(texts, str(number), np.frombuffer(stamp.encode("utf-16-le"), dtype="<u2")[:, None].T, "char")
        cells = np.array([[texts[str(number)].ref for number in range(SAMPLES)]], dtype=h5py.ref_dtype)
        file.create_dataset("stamp", data=cells, dtype=h5py.ref_dtype).attrs["MATLAB_class"] = np.bytes_(b"cell")

    path = matlab(tmp_path / "log.mat", write)
    recording = same(path, "time=stamp", "velocity=log.joint2.q(1)", "torque=log.joint2.tau")
    np.testing.assert_allclose(recording.time, TIME, atol=1e-9)


def test_matlab_vectors_of_the_length_that_is_asked_for(tmp_path: Path) -> None:
    def write(file: Any) -> None:
        for number, length in ((1, SAMPLES), (2, 200), (3, 200)):
            run = file.create_group(f"run{number}")
            for name, values in CHANNELS.items():
                matlab_array(run, name, values[:length])

    same(
        matlab(tmp_path / "log.mat", write),
        *("time=run1.time_s", "velocity=run1.velocity_rad_s", "torque=run1.torque_Nm"),
    )


def linked(file: Any) -> None:
    put(file)
    file["again"] = file  # a group that contains itself
    file["elsewhere"] = h5py.ExternalLink("/etc/hostname", "/x")
    file["nowhere"] = h5py.SoftLink("/there/is/no/such")


def test_links_are_not_followed(tmp_path: Path) -> None:
    same(made(tmp_path / "log.h5", linked))


def test_data_kept_in_other_files_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "raw").write_bytes(CHANNELS["velocity_rad_s"].tobytes())

    def write(file: Any) -> None:
        put(file, {name: values for name, values in CHANNELS.items() if name != "velocity_rad_s"})
        file.create_dataset(
            "velocity_rad_s", shape=(SAMPLES,), dtype="f8", external=[(tmp_path / "raw", 0, 8 * SAMPLES)]
        )

    with pytest.raises(InputError, match="no column for the velocity"):
        read(made(tmp_path / "log.h5", write))


def wide(file: Any) -> None:
    for number in range(10_100):
        file[f"c{number}"] = 1.0


BAD: dict[str, tuple[Callable[[Any], object], str]] = {
    "nothing in it": (lambda file: None, "holds no numeric vectors but nothing"),
    "scalars": (lambda file: file.create_dataset("K", data=3.0), r"holds no numeric vectors but K \(float64 scalar\)"),
    "never written": (
        lambda file: file.create_dataset("time_s", shape=(10**11,), dtype="f8", chunks=(1000,)),
        "unpack to over 800 GB",
    ),
    "all one value": (
        lambda file: file.create_dataset("x", data=np.zeros(40_000_000), compression="gzip", chunks=(1_000_000,)),
        "unpack to over 0.32 GB",
    ),
    "many": (wide, "more than 10000 data sets"),
    "no torque": (lambda file: put(file, {"time_s": TIME, "velocity_rad_s": VELOCITY}), "no column for the torque"),
}
LARGE = ("many", "all one value")


@pytest.mark.parametrize("case", [pytest.param(c, marks=pytest.mark.long if c in LARGE else ()) for c in BAD])
def test_what_cannot_be_used_is_one_line(case: str, tmp_path: Path) -> None:
    write, expected = BAD[case]
    path = made(tmp_path / "log.h5", write)
    with pytest.raises(InputError, match=expected) as refused:
        read(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_other_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "log.h5"
    path.write_text("time_s,torque_Nm\n0,1\n")
    with pytest.raises(InputError, match="is no HDF5 file"):
        read(path)
    made(path, put)
    path.write_bytes(path.read_bytes()[:1500])
    with pytest.raises(InputError, match=r"cannot be read as HDF5.*damaged"):
        read(path)


def test_tables_of_pandas_are_read_by_their_fields(tmp_path: Path) -> None:
    """Fixed-format and compound tables alike keep one row a sample."""
    rows = pd.DataFrame(CHANNELS).to_records(index=False)
    path = made(tmp_path / "log.h5", lambda file: file.create_dataset("table", data=rows))
    same(path, "time=table.time_s", "velocity=table.velocity_rad_s", "torque=table.torque_Nm")


def test_without_h5py_the_line_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = made(tmp_path / "log.h5", put)
    monkeypatch.setitem(__import__("sys").modules, "h5py", None)
    with pytest.raises(InputError, match="pip install h5py"):
        hdf5.Hdf5Reader().table(path)
