"""Several files as one recording, and further channels: what stands in files and what comes out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels.diagnosis import compare
from fricmodels.errors import InputError
from fricmodels.readers import read, read_together
from fricmodels.recording import Recording

Made = Callable[..., Recording]
NAMES = {"time": "time_s", "torque": "torque_Nm", "velocity": "velocity_rad_s", "position": "position_rad"}


@pytest.fixture
def table(made: Made) -> pd.DataFrame:
    recording = made(samples=3000)
    frame = pd.DataFrame({name: recording[channel] for channel, name in NAMES.items()})
    frame["ddq2"] = np.degrees(np.sin(3.1 * recording.time))
    return frame


@pytest.fixture
def files(table: pd.DataFrame, tmp_path: Path) -> list[Path]:
    """Two files, of which the second begins at time 0 again."""
    parts = [table[:1200], table[1200:].assign(time_s=lambda t: t.time_s - t.time_s.iloc[0])]
    for name, part in zip("ab", parts, strict=True):
        part.to_csv(tmp_path / f"{name}.csv", index=False)
    whole = pd.concat([part.assign(run=number) for number, part in enumerate(parts)])
    whole.to_csv(tmp_path / "whole.csv", index=False)
    return [tmp_path / f"{name}.csv" for name in ("a", "b", "whole")]


OTHER = ["other.j2_acceleration=ddq2:deg/s^2"]


def test_files_together_are_one_file_with_a_run_column_to_the_last_bit(files: list[Path]) -> None:
    both, whole = read_together(files[:2], columns=OTHER), read(files[2], columns=OTHER)
    assert both.checksum == whole.checksum
    one, other = (compare(each, "coulomb-viscous+other(j2_acceleration)", 2.0) for each in (both, whole))
    assert one.estimate.parameters == other.estimate.parameters
    assert one.errors == other.errors


def test_files_and_runs_are_kept_in_provenance(files: list[Path]) -> None:
    known = read_together(files[:2]).provenance
    assert known["files"] == [str(file) for file in files[:2]]
    assert known["runs"] == {0: "a", 1: "b"}
    three = read_together([files[2], files[0]], name="days")
    assert three.name == "days"
    assert three.provenance["runs"] == {0: "whole, 0", 1: "whole, 1", 2: "a"}
    assert read_together(files[:1]).checksum == read(files[0]).checksum


def test_other_columns_or_units_are_refused_in_one_line(files: list[Path], table: pd.DataFrame, tmp_path: Path) -> None:
    table.drop(columns="position_rad").to_csv(tmp_path / "c.csv", index=False)
    for pair in ([files[0], tmp_path / "c.csv"], [tmp_path / "c.csv", files[0]]):
        with pytest.raises(
            InputError, match=r"c.csv: has no position, which .*a.csv has; files that are read together"
        ):
            read_together(pair)
    one, other = (table.rename(columns={"ddq2": f"other.drum [{unit}]"}) for unit in ("A", "V"))
    one.to_csv(tmp_path / "one.csv", index=False)
    other.to_csv(tmp_path / "other.csv", index=False)
    with pytest.raises(InputError, match=r"other.csv: other.drum is in V, in .*one.csv in A"):
        read_together([tmp_path / "one.csv", tmp_path / "other.csv"])


@pytest.mark.parametrize(
    "columns",
    [
        ["other.j2_acceleration=ddq2:deg/s^2"],
        ["other.j2_acceleration=ddq2 [deg/s^2]"],
        {"other": {"j2_acceleration": "ddq2 [deg/s^2]"}},
        {"other.j2_acceleration": "ddq2:deg/s**2"},
    ],
)
def test_further_channels_are_mapped_with_their_units(files: list[Path], table: pd.DataFrame, columns: object) -> None:
    recording = read(files[0], columns=columns)  # type: ignore[arg-type]
    assert recording.further == ("other.j2_acceleration",)
    assert recording.units == {"other.j2_acceleration": "rad/s^2"}
    np.testing.assert_allclose(recording["other.j2_acceleration"], np.radians(table["ddq2"][:1200]), rtol=1e-9)


@pytest.mark.parametrize(
    ("header", "unit", "factor"),
    [
        ("other.drum", "", 1.0),
        ("other.drum [rpm]", "rad/s", np.pi / 30),
        ("other.drum (mA)", "A", 1e-3),
        ("other.drum [bar]", "Pa", 1e5),
        ("other.drum [N m/s]", "N m/s", 1.0),
        ("other.drum [g]", "kg", 1e-3),
    ],
)
def test_a_column_of_that_name_needs_no_mapping(
    table: pd.DataFrame, tmp_path: Path, header: str, unit: str, factor: float
) -> None:
    table.rename(columns={"ddq2": header}).to_csv(tmp_path / "d.csv", index=False)
    recording = read(tmp_path / "d.csv")
    np.testing.assert_allclose(recording["other.drum"], factor * table["ddq2"], rtol=1e-9)
    if "N m" not in header:
        assert recording.units == {"other.drum": unit}


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (["other.j 2=ddq2"], "'other.j 2' is no name of a further channel"),
        (["other.j2=ddq3"], "there is no column 'ddq3' for the other.j2; did you mean 'ddq2'"),
        (["other.j2=ddq2:wombats"], "unknown unit"),
        ({"velocity": {"a": "ddq2"}}, "the channel 'velocity' takes one column"),
    ],
)
def test_mappings_that_mean_nothing(files: list[Path], columns: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(files[0], columns=columns)  # type: ignore[arg-type]
