from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.readers import read

HEADER = "time_s,torque_Nm,velocity_rad_s"
ROWS = [f"{0.01 * i:.2f},{np.sin(i):.6f},{np.cos(i):.6f}" for i in range(12)]
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"


def write(directory: Path, lines, name="log.csv", encoding="utf-8") -> Path:
    path = directory / name
    path.write_text("\n".join(lines) + "\n", encoding=encoding)
    return path


def frame() -> pd.DataFrame:
    return pd.DataFrame([[float(x) for x in row.split(",")] for row in ROWS], columns=HEADER.split(","))


@pytest.fixture
def expected(tmp_path):
    return read(write(tmp_path, [HEADER, *ROWS], "expected.csv"), name="log")


def swap(lines, old, new):
    return [line.replace(old, new) for line in lines]


@pytest.mark.parametrize(
    ("lines", "encoding"),
    [
        ([HEADER, *ROWS], "utf-8-sig"),
        ([HEADER, *ROWS], "utf-16"),
        (["# made by hand", "% on a Monday", "", HEADER, ROWS[0], "# a remark", "", *ROWS[1:]], "utf-8"),
        (["# made by numpy.savetxt", "# " + HEADER, *ROWS], "utf-8"),
        (swap(["# " + HEADER, *ROWS], ",", " "), "utf-8"),
        (swap([HEADER, *ROWS], ",", ";"), "utf-8"),
        (swap([HEADER, *ROWS], ",", "\t"), "utf-8"),
        (swap([HEADER, *ROWS], ",", "  "), "utf-8"),
        (swap(swap([HEADER, *ROWS], ",", ";"), ".", ","), "utf-8"),
        (swap([HEADER, *ROWS], ",", " , "), "utf-8"),
        ([HEADER, "[s],[N m],[rad/s]", *ROWS], "utf-8"),
        ([HEADER + ",", *(row + "," for row in ROWS)], "utf-8"),
        ([HEADER, *(row + "," for row in ROWS)], "utf-8"),
        ([HEADER + ",Anmerkung für später", *(row + ",größer" for row in ROWS)], "latin-1"),
    ],
)
def test_the_same_numbers_however_the_text_is_written(tmp_path, expected, lines, encoding):
    recording = read(write(tmp_path, lines, encoding=encoding))
    assert recording.checksum == expected.checksum


def test_parquet_and_matlab_say_the_same_as_csv(tmp_path, expected):
    frame().to_parquet(tmp_path / "log.parquet")
    scipy.io.savemat(tmp_path / "log.mat", {name: frame()[name].to_numpy() for name in frame()} | {"gain": 3.0})
    for name in ("log.parquet", "log.mat"):
        assert read(tmp_path / name).checksum == expected.checksum


def test_matlab_structures_and_matrices(tmp_path, expected):
    table = frame()
    motion = {"w": table["velocity_rad_s"].to_numpy(), "other": np.arange(5.0)}
    scipy.io.savemat(tmp_path / "s.mat", {"log": {"m": motion}, "tx": table[["time_s", "torque_Nm"]].to_numpy()})
    recording = read(tmp_path / "s.mat", columns=["time=tx(1)", "torque=tx(2)", "velocity=log.m.w"])
    assert recording.checksum == expected.checksum


@pytest.mark.parametrize(
    ("content", "message"),
    [({"a": 1.0, "b": "text"}, "no numeric vectors"), ({"z": np.arange(4) * 1j}, "complex")],
)
def test_matlab_without_vectors(tmp_path, content, message):
    scipy.io.savemat(tmp_path / "x.mat", content)
    with pytest.raises(InputError, match=message):
        read(tmp_path / "x.mat")


def test_matlab_7_3_that_is_cut_off_is_named(tmp_path):
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + bytes([0, 2]) + b"IM"
    (tmp_path / "x.mat").write_bytes(header.ljust(512, b"\0") + b"\x89HDF\r\n\x1a\n")
    with pytest.raises(InputError, match=r"cannot be read as HDF5.*damaged"):
        read(tmp_path / "x.mat")


def test_units_in_the_file_and_in_the_mapping(tmp_path):
    path = write(tmp_path, ["t,i,n", "ms,mA,rpm", *ROWS])
    recording = read(path, columns={"time": "t", "torque": "i", "velocity": "n:deg/s"}, torque_constant=0.05)
    table = frame().to_numpy().T
    np.testing.assert_allclose(recording.time, table[0] * 1e-3)
    np.testing.assert_allclose(recording.torque, table[1] * 1e-3 * 0.05)
    np.testing.assert_allclose(recording["current"], table[1] * 1e-3)
    np.testing.assert_allclose(recording.velocity, np.deg2rad(table[2]))
    assert recording.provenance["columns"]["time"] == "time=t:ms"
    assert len(recording.provenance["sha256"]) == 64


def test_current_and_torque_constant(tmp_path):
    path = write(tmp_path, ["time_s,current_A,velocity_rad_s", *ROWS])
    np.testing.assert_allclose(read(path, torque_constant=2.0).torque, 2.0 * frame()["torque_Nm"])
    with pytest.raises(InputError, match="torque constant"):
        read(path)
    with pytest.raises(InputError, match="no current"):
        read(write(tmp_path, [HEADER, *ROWS], "b.csv"), torque_constant=2.0)
    with pytest.raises(InputError, match="finite"):
        read(path, torque_constant=float("nan"))


def test_linear_axis_with_position_only(tmp_path):
    path = write(tmp_path, ["t;F;x", *swap(ROWS, ",", ";")])
    recording = read(path, columns=["time=t", "force=F:kN", "position=x:mm"])
    assert recording.motion is Motion.LINEAR
    assert set(recording.channels) == {"time", "torque", "position"}
    np.testing.assert_allclose(recording["position"], frame()["velocity_rad_s"] * 1e-3)


def test_runs_of_text_that_are_interleaved(tmp_path):
    lines = [HEADER + ",run"]
    for row in ROWS:
        lines += [f"{row},right", f"{row},left"]
    recording = read(write(tmp_path, lines))
    assert recording.provenance["runs"] == {0: "right", 1: "left"}
    assert recording.run.tolist() == [0] * 12 + [1] * 12
    first, second = recording.runs()
    np.testing.assert_array_equal(first.torque, second.torque)


def test_time_stamps_as_text(tmp_path, expected):
    stamps = pd.Timestamp("2024-03-01T10:00:00") + pd.to_timedelta(frame()["time_s"], unit="s")
    lines = [f"{stamp.isoformat()},{row.split(',', 1)[1]}" for stamp, row in zip(stamps, ROWS, strict=True)]
    np.testing.assert_allclose(read(write(tmp_path, [HEADER, *lines])).time, expected.time, atol=1e-9)


def changed(index: int, row: str) -> list[str]:
    return ["# a comment", HEADER, *ROWS[:index], row, *ROWS[index + 1 :]]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([], "empty"),
        (["# only this"], "empty"),
        ([HEADER], "no samples"),
        ([HEADER, ROWS[0]], "1 sample"),
        (ROWS, "columns: 1 to 3, since the file names none"),
        (["# a comment", *ROWS], "columns: 1 to 3, since the file names none"),
        (["time_s,torque_Nm,torque_Nm,velocity_rad_s", *(f"0,{row}" for row in ROWS)], "'torque_Nm' is there 2 times"),
        (changed(3, "0.03,nan,1"), r"line 6, torque .*NaN"),
        (changed(3, "0.03,,1"), r"line 6, torque .*empty field"),
        (changed(3, "0.03,1"), r"line 6, velocity .*empty field"),
        (changed(3, "0.03,1,-inf"), r"line 6, velocity .*infinite"),
        (changed(3, "0.03,much,1"), r"line 6, column 'torque_Nm': 'much' is not a number"),
        ([HEADER, *(f"{i},{i},{'9' * 400}" for i in range(1, 9))], r"line 2, velocity .*infinite"),
        (changed(3, "0.03,1,2,3,4"), r"line 6 has 5 fields"),
        (changed(3, "0.02,1,2"), r"line 6: the time 0.02 s is repeated"),
        (changed(3, "0.015,1,2"), r"line 6: the time goes back from 0.02 s"),
        ([HEADER, *ROWS, *ROWS], r"line 14: the time goes back .*--column run=COLUMN"),
        ([HEADER, *(f"{i},{i},2.5" for i in range(1, 9))], "velocity is 2.5 throughout"),
        (
            [HEADER, *(f"{i},{'nan' if i > 6 else i},{'nan' if i > 2 else i}" for i in range(9))],
            "line 5, velocity .*5 more",
        ),
        ([HEADER, *(f"{i},{i},0" for i in range(1, 9))], "nothing moves"),
        (["time_s,torque_Nm,position_rad", *(f"{i / 10},{i},0.3" for i in range(1, 9))], "nothing moves"),
        (
            [f"{HEADER},position_rad", *(f"{i},{i},0,{i}" for i in range(1, 9))],
            "position moves by 7 rad; take the",
        ),
        (["time_s,torque_Nm,position_rad", *(f"{i / 10},{i},{i * 0.3}" for i in range(1, 9))], "velocity is 3 through"),
        ([HEADER + ",run", *(f"{row},{'' if i == 3 else 'a'}" for i, row in enumerate(ROWS))], "line 5, .*not named"),
        ([HEADER + ",run", *(f"{row},{min(i, 10)}" for i, row in enumerate(ROWS))], "one sample only"),
    ],
)
def test_bad_content_is_one_line_with_the_place(tmp_path, lines, message):
    with pytest.raises(InputError, match=message) as error:
        read(write(tmp_path, lines) if lines else _empty(tmp_path))
    assert "\n" not in str(error.value)
    assert "log.csv" in str(error.value)


def _empty(directory: Path) -> Path:
    (directory / "log.csv").touch()
    return directory / "log.csv"


def test_bad_files(tmp_path):
    write(tmp_path, [HEADER, *ROWS])
    for path, message in [
        (tmp_path / "lag.csv", "no such file; did you mean 'log.csv'"),
        (tmp_path / "not" / "there.csv", "no such file"),
        (tmp_path, "directory"),
        (write(tmp_path, ["x"], "log.xyz"), "no reader knows the file type '.xyz'; known: .csv"),
        (write(tmp_path, ["x"], "log.parquet"), "cannot be read as Parquet"),
        (write(tmp_path, ["x"], "log.mat"), "cannot be read as a MATLAB file"),
    ]:
        with pytest.raises(InputError, match=message) as error:
            read(path)
        assert "\n" not in str(error.value)
    (tmp_path / "b.csv").write_bytes(b"\x00\x01\x02")
    with pytest.raises(InputError, match="not text"):
        read(tmp_path / "b.csv")
    with pytest.raises(InputError, match="did you mean 'csv'"):
        read(tmp_path / "log.csv", reader="cvs")


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=400), st.sampled_from(["csv", "parquet", "mat"]))
def test_any_bytes_are_read_or_refused(tmp_path, content, suffix):
    path = tmp_path / f"any.{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as error:
        read(path)
    assert "\n" not in str(error.value)


def test_the_built_in_readers_are_registered():
    registered = plugins.load().readers
    for name, suffix in [("csv", ".csv"), ("parquet", ".parquet"), ("matlab", ".mat")]:
        assert suffix in registered[name].suffixes
        assert registered.entry(name).distribution == "fricmodels"


@pytest.mark.measured
@pytest.mark.skipif(not DATA.is_dir(), reason="the folder of real measurements is not beside the project")
def test_real_recordings_are_read():
    axis = read(DATA / "emps/emps_id.csv", columns=["time=t", "force=force_N", "position=pos_m"])
    assert (axis.motion, len(axis), round(1 / axis.interval)) == (Motion.LINEAR, 24841, 1000)
    servo = read(
        DATA / "bam_xl330/xl330_pendulum_16logs.csv",
        columns=["time=t", "torque=motor_volt_V:0.3 N m", "velocity=vel_rads", "position=pos_rad", "run=log"],
    )
    assert (servo.motion, len(set(servo.run.tolist()))) == (Motion.ROTARY, 16)
    arm = read(
        DATA / "kuka_kr300/kr300_trajA_250Hz.csv",
        columns=["time=t", "torque=motor_torque1_Nm", "velocity=vel1_rads", "load_torque=model_gravity1_Nm"],
    )
    assert len(arm) == 2501


@pytest.mark.parametrize("stamp", ["23:59:57.{:03d}", "01.05.24 23:59:57.{:03d}", "13/13/2024 11:59:57.{:03d} PM"])
def test_a_clock_that_is_not_iso_is_told_how_to_be_read(tmp_path, stamp):
    rows = [f"{stamp.format(2 * i)},{np.cos(i / 9)},{np.sin(i / 9)}" for i in range(100)]
    path = tmp_path / "clock.csv"
    path.write_text("\n".join(["time_s,torque_Nm,velocity_rad_s", *rows]))
    with pytest.raises(InputError, match=r"ISO 8601 .* --column time=row:2ms"):
        read(path)
    assert read(path, columns=["time=row:2ms"]).interval == pytest.approx(2e-3)


def test_what_is_no_path_is_refused_in_one_line() -> None:
    with pytest.raises(InputError, match="read takes the path of a file, got a dict; write a table to a file first"):
        read({"time_s": [0.0, 1.0]})  # type: ignore[arg-type]
