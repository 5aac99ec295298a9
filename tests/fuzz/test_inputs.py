"""Whatever stands in a file, a unit or a mapping: an answer, or one line with what is wrong; soon, in little memory.

The same properties are tried on a few hundred inputs here and on a hundred thousand by ``make test-long``; how many of
which kind is in ``docs/reliability.md``.
"""

from __future__ import annotations

import io
import resource
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.cli.boundary import one_line
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.readers import columns, read, units
from fricmodels.rig import load_rig
from fricmodels.tournament import load_config
from fricmodels.tournament.sources import sources

Property = Callable[[], None]
COUNTS = {
    "units": (400, 30_000),
    "columns": (300, 25_000),
    "csv": (250, 20_000),
    "csv without names": (100, 10_000),
    "json": (150, 10_000),
    "jsonl": (100, 5_000),
    "tournament": (200, 13_000),
    "rig": (200, 10_000),
    "parquet": (150, 4_000),
    "matlab": (4, 100),
    "hdf5": (4, 100),
    "matlab 7.3": (4, 100),
}
"""Kind of input → how many are tried here, and by ``make test-long``."""
LENGTHS = [pytest.param(0, id="short"), pytest.param(1, id="long", marks=pytest.mark.long)]
ROOM = 1_000_000  # kB that the whole of it may take beyond what was taken before


@pytest.fixture(autouse=True)
def bounded_memory() -> Iterator[None]:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    yield
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + ROOM


def tried(kind: str, length: int) -> settings:
    """Return how the property of a kind is tried: each input has ten seconds."""
    return settings(settings.get_profile("ten-seconds"), max_examples=COUNTS[kind][length], derandomize=length == 0)


def answered(work: Callable[[], object]) -> None:
    """Do some work; it may say in one line why it cannot be done, and fail in no other way."""
    line = "-"
    try:
        work()
    except InputError as error:
        line = one_line(str(error))
    assert line
    assert line.isprintable()
    assert len(line) <= 1001


HOSTILE = [
    "", "nan", "inf", "-1", "0", "1e308", "1e-320", "1" * 400, "x" * 200, "null", "~", "true", "[]", "{}",
    "[1, [2]]", "*a", "&a [*a]", "!!bool maybe", "!!timestamp never", "!!int ''", "!!binary x",
    "!!python/object:os.system x", "<<", "2020-13-45", "0x1g", "1:60:99", "\u0000", "\ufeff", "\ud800",
    "\u202e", "\u001b[2J", "=cmd", "../../x", "'", "\"", "|", ">", "%", "`", "- -", "? :", "10**10**8*s",
    "2000000000", "deg", "rpm", "((((", "\u00b2\u00b2\u00b2", "\u03c3", ",", ";", "\t", "#", "\r", "9" * 5000,
    "9e9999",
]  # fmt: skip
PIECES = st.sampled_from(HOSTILE) | st.text(max_size=8) | st.floats().map(repr) | st.integers().map(str)


@st.composite
def edited(draw: st.DrawFn, text: str) -> bytes:
    """Draw a text with edits: pieces for a word, a column or nothing, parts left out or twice, bytes changed."""
    for _ in range(draw(st.integers(1, 3))):
        how = draw(st.sampled_from(["insert", "word", "column", "drop", "line", "cut"]))
        place = draw(st.integers(0, max(len(text) - 1, 0)))
        end = min(len(text), place + draw(st.integers(0, 20)))
        if how == "insert":
            text = text[:place] + draw(PIECES) + text[place:]
        elif how == "word":
            start = max(text.rfind(mark, 0, place) for mark in " ,:\n[{") + 1
            stop = min((at for mark in " ,\n]}" if (at := text.find(mark, place)) >= 0), default=len(text))
            text = text[:start] + draw(PIECES) + text[stop:]
        elif how == "column":
            piece, number = draw(PIECES), draw(st.integers(0, 3))
            text = "\n".join(replaced(line, number, piece) if i else line for i, line in enumerate(text.split("\n")))
        elif how == "drop":
            text = text[:place] + text[end:]
        elif how == "line":
            lines = text.splitlines(keepends=True) or [""]
            line = lines[place % len(lines)]
            text = text[:place] + line + text[place:]
        else:
            text = text[:place]
    content = text.encode(draw(st.sampled_from(["utf-8", "utf-8", "utf-8", "utf-16", "latin-1"])), errors="replace")
    return spoilt(draw, content) if draw(st.integers(0, 3)) == 0 else content


def replaced(line: str, number: int, piece: str) -> str:
    """Return a line with something else in the place of one of its words."""
    words = line.split(",")
    return ",".join([*words[:number], piece, *words[number + 1 :]]) if number < len(words) and line else line


def spoilt(draw: st.DrawFn, content: bytes) -> bytes:
    """Change a few bytes."""
    changed = bytearray(content or b"\0")
    for _ in range(draw(st.integers(1, 4))):
        changed[draw(st.integers(0, len(changed) - 1))] = draw(st.integers(0, 255))
    return bytes(changed)


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """Draw a binary file with a few bytes changed, often near its ends where the headers stand, or cut off."""
    if draw(st.integers(0, 9)) == 0:
        return content[: draw(st.integers(0, len(content)))]
    changed = bytearray(content)
    for _ in range(draw(st.integers(1, 5))):
        place = draw(st.integers(0, min(len(changed), 600) - 1))
        changed[place if draw(st.booleans()) else -1 - place] = draw(st.integers(0, 255))
    return bytes(changed)


@cache
def motion() -> pd.DataFrame:
    time = 0.01 * np.arange(60)
    velocity = np.sin(20 * time)
    torque = 0.1 * velocity + 0.2 * np.sign(velocity)
    return pd.DataFrame({"time_s": time, "torque_Nm": torque, "velocity_rad_s": velocity, "run": 1})


@cache
def parquet() -> bytes:
    stream = io.BytesIO()
    motion().to_parquet(stream)
    return stream.getvalue()


@cache
def matlab() -> bytes:
    stream = io.BytesIO()
    scipy.io.savemat(stream, {name: values.to_numpy() for name, values in motion().items()}, do_compression=True)
    return stream.getvalue()


@cache
def hdf5(groups: bool) -> bytes:
    """Return a file with chunks, compression and units, its data sets in the root or in two groups."""
    import h5py

    stream = io.BytesIO()
    with h5py.File(stream, "w") as file:
        for group in [file.create_group("a"), file.create_group("b/c")] if groups else [file]:
            for name, values in motion().items():
                group.create_dataset(str(name), data=values.to_numpy()[None], chunks=(1, 20), compression="gzip")
                group[name].attrs["unit"] = ""
                group[name].attrs["MATLAB_class"] = np.bytes_(b"double")
    return stream.getvalue()


TOURNAMENT = """\
name: test
datasets:
  - name: motor
    simulate:
      model: coulomb-viscous
      parameters: {K_v: 1.0e-4, K_c: 1e-2}
      inertia: 4.87e-6
      amplitude: [0.02, 0.03]
      frequency: 39.54
      seeds: 3
  - {name: log, files: log.csv, columns: {velocity: "qd:deg/s", other: {load: "tau:N*m"}}, runs: [1, 2], optional: true}
models: [coulomb-viscous, square-root+gravity]
estimators: [{name: batch, label: b}, rls]
split: {by: spread}
timeout: 10
"""
RIG = """\
inertia: 4.87e-6
friction: {viscous: 1.0e-4, coulomb: [1.0e-2, 1.1e-2]}
effects:
  - {name: gravity, sine: 0.003}
  - {name: cogging, harmonics: [{order: 6, amplitude: 0.001}]}
excitation: {kind: tracking, velocity: 20, frequency: 0.5, bandwidth: 20}
sensors: {velocity_noise_percent: 0.1}
rate: 1000
samples: 8000
seed: 3
"""


def finite(path: Path) -> None:
    recording = read(path)
    assert all(np.isfinite(values).all() for values in recording.channels.values())


def planned(path: Path) -> None:
    listed, _ = sources(load_config(path), path.parent)
    assert len(listed) <= 200_000


@pytest.mark.parametrize("length", LENGTHS)
def test_units(length: int) -> None:
    words = [
        "s",
        "deg",
        "rad",
        "N",
        "m",
        "count",
        "turn",
        "degC",
        "/",
        "*",
        "**",
        "^",
        "·",
        "(",
        ")",
        "-",
        "1",
        "12",
        "1e3",
        "2000",
    ]

    @tried("units", length)
    @given(st.lists(st.sampled_from([*words, " ", "²", "⁻¹"]), max_size=9).map("".join) | st.text(max_size=12) | PIECES)
    def known_or_not(unit: str) -> None:
        for channel in ("velocity", "time", "torque"):
            answered(partial(units.conversion, unit, channel, Motion.ROTARY))
        answered(lambda: units.further(unit))

    known_or_not()


@pytest.mark.parametrize("length", LENGTHS)
def test_columns(length: int) -> None:
    names = (
        st.sampled_from(["time_s", "t", "qd [deg/s]", "velocity_rad_s", "other.x", "a:b", "a=b", "run", "torque_Nm"])
        | PIECES
    )
    channels = st.sampled_from(["time", "velocity", "torque", "force", "other.y"]) | PIECES
    stated = st.sampled_from(["", ":", ":s", ":deg/s", ":("])
    mapped = st.builds("{}={}{}".format, channels, names, stated)

    @tried("columns", length)
    @given(st.lists(mapped | PIECES, max_size=4), st.lists(names, max_size=6), st.sampled_from([None, *Motion]))
    def assigned(given_: list[str], present: list[str], kind: Motion | None) -> None:
        answered(lambda: columns.assign(given_, present, kind))

    assigned()


def of_files(
    kind: str, length: int, path: Path, content: st.SearchStrategy[bytes], work: Callable[[Path], object]
) -> None:
    """Try a property on many contents of one file."""

    @tried(kind, length)
    @given(content)
    def one(text: bytes) -> None:
        path.write_bytes(text)
        answered(lambda: work(path))

    one()


@pytest.mark.parametrize("length", LENGTHS)
def test_csv(length: int, tmp_path: Path) -> None:
    of_files("csv", length, tmp_path / "log.csv", edited(motion().to_csv(index=False)), finite)


@pytest.mark.parametrize("length", LENGTHS)
def test_csv_without_names(length: int, tmp_path: Path) -> None:
    of_files(
        "csv without names", length, tmp_path / "log.csv", edited(motion().to_csv(index=False, header=False)), finite
    )


@pytest.mark.parametrize("length", LENGTHS)
def test_json(length: int, tmp_path: Path) -> None:
    shapes = [edited(motion().to_json(orient=shape)) for shape in ("records", "columns", "values")]
    of_files("json", length, tmp_path / "log.json", st.one_of(shapes), finite)


@pytest.mark.parametrize("length", LENGTHS)
def test_an_object_a_line(length: int, tmp_path: Path) -> None:
    of_files("jsonl", length, tmp_path / "log.jsonl", edited(motion().to_json(orient="records", lines=True)), finite)


@pytest.mark.parametrize("length", LENGTHS)
def test_tournament(length: int, tmp_path: Path) -> None:
    of_files("tournament", length, tmp_path / "config.yaml", edited(TOURNAMENT), planned)


@pytest.mark.parametrize("length", LENGTHS)
def test_rig(length: int, tmp_path: Path) -> None:
    of_files("rig", length, tmp_path / "rig.yaml", edited(RIG), load_rig)


@pytest.mark.parametrize("length", LENGTHS)
def test_parquet(length: int, tmp_path: Path) -> None:
    of_files("parquet", length, tmp_path / "log.parquet", damaged(parquet()), finite)


@pytest.mark.long
@pytest.mark.parametrize("length", LENGTHS)
def test_matlab(length: int, tmp_path: Path) -> None:
    of_files("matlab", length, tmp_path / "log.mat", damaged(matlab()), finite)


@pytest.mark.parametrize("length", LENGTHS)
def test_hdf5(length: int, tmp_path: Path) -> None:
    of_files("hdf5", length, tmp_path / "log.h5", damaged(hdf5(False)) | damaged(hdf5(True)), finite)


@pytest.mark.long
@pytest.mark.parametrize("length", LENGTHS)
def test_matlab_of_version_7_3(length: int, tmp_path: Path) -> None:
    of_files("matlab 7.3", length, tmp_path / "log.mat", damaged(hdf5(False)) | damaged(hdf5(True)), finite)


def test_what_is_edited_is_right_without_edits(tmp_path: Path) -> None:
    for name, content in (
        ("log.csv", motion().to_csv(index=False).encode()),
        ("log.json", motion().to_json(orient="records").encode()),
        ("log.parquet", parquet()),
        ("log.mat", matlab()),
        ("log.h5", hdf5(False)),
    ):
        (tmp_path / name).write_bytes(content)
        finite(tmp_path / name)
    (tmp_path / "config.yaml").write_text(TOURNAMENT)
    planned(tmp_path / "config.yaml")
    (tmp_path / "rig.yaml").write_text(RIG)
    load_rig(tmp_path / "rig.yaml")
