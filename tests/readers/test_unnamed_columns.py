"""Files that name their columns nowhere, or before every number."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.errors import InputError
from fricmodels.readers import read
from fricmodels.readers.labelled import labels_of, without_labels

MAPPED = ("time=1:ms", "torque=2:mN*m", "position=4:deg")
NAMED = ("time=t [ms]", "torque=T [mN*m]", "position=angle [deg]")
HEADER = ("t [ms]", "T [mN*m]", "spare", "angle [deg]")


def rows(count: int = 40) -> list[tuple[str, ...]]:
    """Return rows of a motion that turns, as text."""
    angle = 90.0 * np.sin(0.3 * np.arange(count))
    return [(f"{10 * i}", f"{0.5 * i:.2f}", "7", f"{value:.3f}") for i, value in enumerate(angle)]


def write(path: Path, lines: list[tuple[str, ...]], mark: str, decimal: str = ".") -> Path:
    path.write_text("\n".join(mark.join(line).replace(".", decimal) for line in lines) + "\n")
    return path


@pytest.mark.parametrize(("mark", "decimal"), [(",", "."), ("\t", "."), (" ", "."), (";", ","), ("\t", ",")])
def test_columns_without_names_are_called_by_their_number(tmp_path: Path, mark: str, decimal: str) -> None:
    bare = read(write(tmp_path / "bare.csv", rows(), mark, decimal), columns=MAPPED)
    named = read(write(tmp_path / "named.csv", [HEADER, *rows()], ";"), columns=NAMED)
    assert len(bare) == 40, "the first row is data"
    for channel in ("time", "torque", "position"):
        assert np.array_equal(bare[channel], named[channel])


def test_the_error_says_how_many_there_are_and_that_none_has_a_name(tmp_path: Path) -> None:
    path = write(tmp_path / "bare.dat", rows(), "\t")
    with pytest.raises(InputError, match=r"map them with --column time=COLUMN.*columns: 1 to 4, since the file names"):
        read(path)
    with pytest.raises(InputError, match="there is no column '5' for the position; columns: 1 to 4, since"):
        read(path, columns=["time=1:ms", "torque=2", "position=5"])


def test_a_bad_value_is_found_at_its_line(tmp_path: Path) -> None:
    lines = rows()
    lines[6] = ("60", "much", "7", "3.0")
    with pytest.raises(InputError, match=r"line 7, column '2': 'much' is not a number"):
        read(write(tmp_path / "bare.csv", lines, ","), columns=MAPPED)


@pytest.mark.parametrize("between", [" ", ", ", "\t", ";"])
@pytest.mark.parametrize("mark", [":", ": ", " = "])
def test_numbers_with_their_names_before_them(tmp_path: Path, between: str, mark: str) -> None:
    names = ("Time", "motor torque", "spare", "Angle (raw)")
    path = tmp_path / "board.txt"
    path.write_text("\n".join(between.join(map(f"{{}}{mark}{{}}".format, names, row)) for row in rows()) + "\n")
    mapped = ("time=Time:ms", "torque=motor torque:mN*m", "position=Angle (raw):deg")
    found = read(path, columns=mapped)
    bare = read(write(tmp_path / "bare.csv", rows(), ","), columns=MAPPED)
    for channel in ("time", "torque", "position"):
        assert np.array_equal(found[channel], bare[channel])


def test_a_line_of_text_between_them_is_found(tmp_path: Path) -> None:
    lines = [f"time_s: {i / 10} torque_Nm: {i} velocity_rad_s: {np.sin(i):.3f}" for i in range(20)]
    lines.insert(5, "DONE POSITIONING")
    (tmp_path / "board.txt").write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"board\.txt: line 6, column 'time_s': 'DONE POSITIONING' is not a number"):
        read(tmp_path / "board.txt")


@pytest.mark.parametrize("line", ["t,x,y", "0.1 0.2 0.3", "time: now, x: 3", "only: 3", "a: 1 a: 2", "12:30:05, 3.4"])
def test_other_lines_are_none(line: str) -> None:
    assert labels_of(line) is None


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3))
def test_every_number_is_read_as_it_stands(values: list[float]) -> None:
    line = "q1:{}, torque [Nm]:{},v:{}".format(*map(repr, values))
    assert labels_of(line) == ["q1", "torque [Nm]", "v"]
    assert [float(x) for x in without_labels(line, ["q1", "torque [Nm]", "v"]).split(",")] == values


EPOS = (
    "Date:;2020-07-09 22:38:08",
    "Firmware Version:;0x0120;0x6150;0x0000;0x0000",
    "Recorded samples:;500",
    'Trigger:;1;0.000000;"Parameter values";"Rising above value"',
)
SCOPE = ("Name\tProject 1", "File\tC:\\log.svdx", "Start\t12:00\t17.3", "")
PROSE = ("measured on the bench, 3 A", "", "sampling 10 ms")


@pytest.mark.parametrize(("preamble", "mark", "decimal"), [(EPOS, ";", ","), (SCOPE, "\t", "."), (PROSE, ",", ".")])
@pytest.mark.parametrize("names", ["names", "names and units", "none"])
def test_what_a_recorder_writes_before_its_table(
    tmp_path: Path, preamble: tuple[str, ...], mark: str, decimal: str, names: str
) -> None:
    table = write(tmp_path / "table.csv", rows(), mark, decimal).read_text()
    bare = read(tmp_path / "table.csv", columns=MAPPED)
    header = {"names": HEADER, "names and units": ("t", "T", "spare", "angle"), "none": None}[names]
    lines = [*preamble, *([mark.join(header)] if header else [])]
    lines += [mark.join(("ms", "mN*m", "-", "deg"))] if names == "names and units" else []
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines) + "\n" + table)
    mapped = {"names": NAMED, "names and units": ("time=t", "torque=T", "position=angle"), "none": MAPPED}[names]
    found = read(path, columns=mapped)
    for channel in ("time", "torque", "position"):
        assert np.array_equal(found[channel], bare[channel])
    spoilt = path.read_text().splitlines()
    spoilt[-1] = spoilt[-1].replace(mark, f"{mark}much", 1)
    path.write_text("\n".join(spoilt))
    with pytest.raises(InputError, match=f"line {len(spoilt)}, column .*much.* is not a number"):
        read(path, columns=mapped)


TITLE, GROUPS, IDS = "Servo trace;;;", "Axis 1;Axis 1;Axis 1;Axis 1", "CH1;CH2;CH3;CH4"


ABOVE = ((TITLE,), (TITLE, "Date;2026-03-01;;"), (GROUPS,), (TITLE, GROUPS))


@pytest.mark.parametrize(
    ("above", "units"), [((IDS,), "in names"), *((one, units) for one in ABOVE for units in ("in names", "below"))]
)
def test_lines_as_wide_as_the_table_above_its_names(tmp_path: Path, above: tuple[str, ...], units: str) -> None:
    """A spreadsheet fills a title up with empty fields; a group or a number stands above each column."""
    names = ("Time [ms];Torque [mNm];Spare;Position [deg]",)
    if units == "below":
        names = ("Time;Torque;Spare;Position", "ms;mN*m;-;deg")
    numbers = [f"{10 * i};{50 * np.sin(i):.2f};7;{20 * np.cos(0.3 * i):.3f}" for i in range(20)]
    (tmp_path / "log.csv").write_text("\n".join([*above, *names, *numbers]))
    columns = [line.split(" [")[0] if units == "below" else line for line in names[0].split(";")]
    mapped = (f"time={columns[0]}", f"torque={columns[1]}", f"position={columns[3]}")
    found = read(tmp_path / "log.csv", columns=mapped)
    assert found.time[1] == pytest.approx(0.01)
    assert found.torque[1] == pytest.approx(0.04207)
    assert found["position"][0] == pytest.approx(np.radians(20))


def test_a_column_without_a_name_beside_others_is_called_by_its_number(tmp_path: Path) -> None:
    lines = ["Date:;2020-07-09", ";speed;load", "ms;rpm;%", *(f"{10 * i};{50 * np.sin(i):.2f};{i}" for i in range(20))]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    found = read(tmp_path / "log.csv", columns=("time=1", "velocity=speed", "torque=load:0.1N*m"))
    assert found.time[1] == pytest.approx(0.01)
    assert found.torque[3] == pytest.approx(0.3)
    assert found.velocity[1] == pytest.approx(42.07 * np.pi / 30)
    with pytest.raises(InputError, match=r"'%' .*100 %.*as in torque=COLUMN:0\.1N\*m"):
        read(tmp_path / "log.csv", columns=("time=1", "velocity=speed", "torque=load"))


@pytest.mark.parametrize("blank", [" ", "\t", ", ", ";"])
def test_many_blanks_take_no_time(blank: str) -> None:
    """The time of a search that goes back over them grows with their cube: minutes for some thousand."""
    line = "a:1" + blank * 50_000 + "b:2"
    started = time.process_time()
    assert labels_of("a" + blank * 50_000 + "b") is None
    found = without_labels(line + "\na:3" + blank * 50_000, ["a", "b"])
    assert time.process_time() - started < 2.0
    assert found.splitlines()[0] == "1,2"
