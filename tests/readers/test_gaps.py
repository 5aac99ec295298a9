"""Rows that cannot be used are left out where that is asked for, counted and said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels.cli import main
from fricmodels.errors import InputError
from fricmodels.readers import read, read_together
from fricmodels.recording import Recording


def motion(samples: int = 40) -> pd.DataFrame:
    time = 0.01 * np.arange(samples)
    velocity = np.sin(20 * time)
    return pd.DataFrame({"time_s": time, "torque_Nm": 0.2 * np.sign(velocity) + velocity, "velocity_rad_s": velocity})


def spoilt() -> pd.DataFrame:
    """Rows 5, 6 and 20 without a number, row 30 twice."""
    table = motion()
    table.loc[[5, 6], "torque_Nm"] = np.nan
    table.loc[20, "velocity_rad_s"] = np.inf
    return pd.concat([table.iloc[:31], table.iloc[30:]], ignore_index=True)


def write(path: Path, table: pd.DataFrame) -> Path:
    table.to_csv(path, index=False)
    return path


def lengths(recording: Recording) -> list[int]:
    return np.unique(recording.run, return_counts=True)[1].tolist()


def test_dropped_rows_are_counted(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", spoilt())
    with pytest.raises(InputError, match="--gaps drop or --gaps split"):
        read(path)
    recording = read(path, gaps="drop")
    good = motion().drop(index=[5, 6, 20])
    np.testing.assert_array_equal(recording.time, good["time_s"])
    np.testing.assert_array_equal(recording.torque, good["torque_Nm"])
    assert lengths(recording) == [37]
    assert recording.provenance["gaps"] == "4 rows without a number or with a repeated stamp left out"


def test_a_new_run_begins_after_each_gap(tmp_path: Path) -> None:
    recording = read(write(tmp_path / "log.csv", spoilt()), gaps="split")
    assert lengths(recording) == [5, 13, 19]
    assert recording.provenance["gaps"] == "4 rows without a number or with a repeated stamp left out, 2 runs added"


def test_a_clock_that_starts_anew_begins_a_run(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", pd.concat([motion(30), motion(20), motion(10)]))
    for how in (None, "drop"):
        with pytest.raises(InputError, match=r"the time goes back .*; begin a run there with --gaps split, "):
            read(path, gaps=how)  # type: ignore[arg-type]
    recording = read(path, gaps="split")
    assert lengths(recording) == [30, 20, 10]
    assert recording.run.tolist() == [0] * 30 + [1] * 20 + [2] * 10


def test_a_whole_recording_stays_as_it_is(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", motion().assign(run=[3] * 20 + [7] * 20))
    plain = read(path)
    for how in ("drop", "split"):
        recording = read(path, gaps=how)  # type: ignore[arg-type]
        assert recording.checksum == plain.checksum
        assert recording.run.tolist() == plain.run.tolist()
        assert "gaps" not in recording.provenance


def test_a_run_of_one_row_is_left_out(tmp_path: Path) -> None:
    table = motion()
    table.loc[[1, 10, 12], "torque_Nm"] = np.nan
    recording = read(write(tmp_path / "log.csv", table), gaps="split")
    assert lengths(recording) == [8, 27]
    said = "3 rows without a number or with a repeated stamp left out, 2 rows that stood alone left out"
    assert recording.provenance["gaps"].startswith(said)


def test_nothing_left_is_an_error(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", motion().assign(torque_Nm=np.nan))
    with pytest.raises(InputError, match="no row has a number in every channel"):
        read(path, gaps="drop")


def test_several_files_and_the_command_say_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [write(tmp_path / f"{name}.csv", spoilt()) for name in "ab"]
    together = read_together(paths, gaps="split")
    assert lengths(together) == [5, 13, 19] * 2
    assert together.provenance["gaps"].count("4 rows") == 2
    with pytest.raises(SystemExit) as stopped:
        main(["info", str(paths[0]), "--gaps", "drop"])
    assert stopped.value.code == 0
    assert f"warning: {paths[0]}: 4 rows without a number" in capsys.readouterr().err
