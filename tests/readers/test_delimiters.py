"""What stands between the columns of a text file, where that is not one and the same comma."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import read
from fricmodels.recording import Recording

NAMES = ["t", "q_deg", "tau [N*m]"]
ROWS = [[f"{0.002 * i:.3f}", f"{20 * np.sin(0.3 * i):.3f}", f"{np.cos(0.3 * i):.5f}"] for i in range(60)]
COLUMNS = ("time=t", "position=q_deg", "torque=tau [N*m]")


def written(path: Path, between_names: str, between: str, decimal: str = ".", names: list[str] = NAMES) -> Recording:
    rows = [between.join(row).replace(".", decimal) if decimal == "," else between.join(row) for row in ROWS]
    (path / "log.csv").write_text("\n".join([between_names.join(names), *rows]) + "\n")
    return read(path / "log.csv", columns=COLUMNS)


@pytest.mark.parametrize(
    ("between_names", "between", "decimal"),
    [
        ("|", "|", "."),
        (" | ", " | ", "."),
        ("|", "|", ","),
        (",", ";", "."),
        (",", ";", ","),
        (";", ",", "."),
        (",", "\t", "."),
    ],
)
def test_strokes_and_names_that_are_parted_by_another_mark_are_read(
    tmp_path: Path, between_names: str, between: str, decimal: str
) -> None:
    found = written(tmp_path, between_names, between, decimal)
    expected = written(tmp_path, ",", ",")
    for channel in ("time", "position", "torque"):
        assert np.array_equal(found[channel], expected[channel])


def test_a_stroke_within_a_name_parts_nothing(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("\n".join(["t,q_deg,tau [N*m],|v|", *(",".join([*row, "1.0"]) for row in ROWS)]))
    assert len(read(tmp_path / "log.csv", columns=COLUMNS)) == len(ROWS)


def test_commas_within_the_numbers_and_between_them_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 2 has 6 fields where the header names 3 columns: commas stand within"):
        written(tmp_path, ",", ",", ",")


def test_whole_numbers_below_the_settings_of_a_recorder_are_no_decimals(tmp_path: Path) -> None:
    rows = [f"{i},{int(100 * np.sin(0.3 * i))},{int(50 * np.cos(0.3 * i))}" for i in range(60)]
    (tmp_path / "log.csv").write_text("\n".join(["recorder,X1", "serial,7", *rows]) + "\n")
    assert len(read(tmp_path / "log.csv", columns=("time=1:ms", "position=2:deg", "torque=3:mN*m"))) == 60


@pytest.mark.parametrize("mark", ["%", "# ", "%% "])
def test_a_comment_above_rows_with_texts_names_the_columns(tmp_path: Path, mark: str) -> None:
    """As ``rostopic echo -p`` writes them: an empty frame and the names of joints stand in every row."""
    names = ["time", "field.header.frame_id", "field.name0", "field.name1", *NAMES[1:]]
    rows = [",".join([time, "", "shoulder_pan", "elbow", *rest]) for time, *rest in ROWS]
    (tmp_path / "log.csv").write_text("\n".join([mark + ",".join(names), *rows]) + "\n")
    columns = ("time=time:s", "position=q_deg", "torque=tau [N*m]")
    found = read(tmp_path / "log.csv", columns=columns)
    assert len(found) == len(ROWS)
    assert found.torque[0] == pytest.approx(1.0)


def test_a_comment_above_a_header_is_no_header(tmp_path: Path) -> None:
    """It has as many words as there are columns, and the line below it names them."""
    lines = ["# bench two, run three", ",".join(NAMES), *(",".join(row) for row in ROWS)]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    assert len(read(tmp_path / "log.csv", columns=COLUMNS)) == len(ROWS)
