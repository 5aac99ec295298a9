"""Whatever stands in a file that the program wrote itself: an answer, or one line with what is wrong."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from copy import deepcopy
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fricmodels
from fricmodels.cli.boundary import one_line
from fricmodels.diagnosis import compare
from fricmodels.diagnosis.journal import Journal
from fricmodels.dimension import Motion
from fricmodels.errors import FricmodelsError
from fricmodels.export.targets import export_model
from fricmodels.recording import Recording
from fricmodels.results.history import SCHEMA, Course, Histories, ParameterHistory
from fricmodels.saved import keep
from fricmodels.sums import load, of_file, pilot, plan_for, solved
from fricmodels.tournament.histories import read_histories

COUNTS = {"sums": (40, 3_000), "model": (60, 4_000), "histories": (60, 4_000), "journal": (100, 6_000)}
"""Kind of file → how many are tried here, and by ``make test-long``."""
LENGTHS = [pytest.param(0, id="short"), pytest.param(1, id="long", marks=pytest.mark.long)]
VALUES = [
    None,
    True,
    -1,
    0,
    1e308,
    -1e-320,
    10**18,
    "",
    "nan",
    "x" * 200,
    "\u001b[2J",
    "../../x",
    [],
    {},
    [[]],
    {"": 0},
]


def arm() -> pd.DataFrame:
    time = 0.002 * np.arange(6000)
    velocity = 4 * np.sin(2.1 * time) + 3 * np.sin(5.3 * time)
    slope = 8.4 * np.cos(2.1 * time) + 15.9 * np.cos(5.3 * time)
    torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity)
    noisy = velocity + 0.01 * np.random.default_rng(1).standard_normal(len(time))
    return pd.DataFrame({"time_s": time, "torque_Nm": torque, "velocity_rad_s": noisy})


@cache
def model() -> str:
    frame = arm()
    names = {"time": "time_s", "torque": "torque_Nm", "velocity": "velocity_rad_s"}
    channels = {name: frame[column].to_numpy() for name, column in names.items()}
    recording = Recording("arm", Motion.ROTARY, channels, np.zeros(len(frame), dtype=np.int64))
    return keep(compare(recording, "coulomb-viscous", 0.05)).document.to_json()


def histories() -> str:
    course = Course(unit="N m", estimates=(0.1, None, 0.3), deviations=(0.1, 0.1, 0.1), final=0.3, standard_error=0.1)
    fit = ParameterHistory(
        model="coulomb-viscous", estimator="rls", dataset="arm", kept=3, time=(0.0, 1.0, 2.0), courses={"K_c": course}
    )
    return Histories(schema_=SCHEMA, fits=(fit,)).to_json()


@st.composite
def changed(draw: st.DrawFn, text: str) -> bytes:
    """Draw a document with a few values replaced or left out, keys renamed, or the text cut or spoilt."""
    content = json.loads(text)
    for _ in range(draw(st.integers(1, 3))):
        place = content
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            if not keys:
                break
            key = draw(st.sampled_from(keys))
            inner = place[key]
            if isinstance(inner, dict | list) and inner and draw(st.integers(0, 3)):
                place = inner
                continue
            how = draw(st.sampled_from(["replace", "drop", "rename"]))
            if how == "replace":
                place[key] = draw(
                    st.sampled_from(VALUES).map(deepcopy) | st.floats(allow_nan=False, allow_infinity=False)
                )
            elif how == "drop":
                del place[key]
            elif isinstance(place, dict):
                place[draw(st.text(max_size=5))] = place.pop(key)
            break
    return spoilt(draw, json.dumps(content).encode()) if draw(st.integers(0, 4)) == 0 else json.dumps(content).encode()


def spoilt(draw: st.DrawFn, content: bytes) -> bytes:
    """Cut a text, or change a few of its bytes."""
    if draw(st.booleans()):
        return content[: draw(st.integers(0, len(content)))]
    changed = bytearray(content)
    for _ in range(draw(st.integers(1, 4))):
        changed[draw(st.integers(0, len(changed) - 1))] = draw(st.integers(0, 255))
    return bytes(changed)


def tried(kind: str, length: int, content: st.SearchStrategy[bytes], path: Path, work: Callable[[], object]) -> None:
    """Try a property on many contents of one file; each has ten seconds."""

    @settings(settings.get_profile("ten-seconds"), max_examples=COUNTS[kind][length], derandomize=length == 0)
    @given(content)
    def one(text: bytes) -> None:
        path.write_bytes(text)
        line = "-"
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                work()
        except FricmodelsError as error:
            line = one_line(str(error))
        assert line.isprintable()
        assert 0 < len(line) <= 1001

    one()


@pytest.fixture(scope="module")
def sums(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("sums") / "arm.parquet"
    arm().to_parquet(path)
    return of_file(path, plan_for(pilot(path), "coulomb-viscous")).to_json()


@pytest.mark.parametrize("length", LENGTHS)
def test_sums(length: int, sums: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.sums.json"

    def fitted() -> None:
        found = solved(load(path))
        assert all(np.isfinite(value) for value in found.parameters.values())

    tried("sums", length, changed(sums), path, fitted)


@pytest.mark.parametrize("length", LENGTHS)
def test_model(length: int, tmp_path: Path) -> None:
    path = tmp_path / "arm.model.json"

    def used() -> None:
        kept = fricmodels.load(path)
        assert repr(kept)
        assert export_model(kept, "c").text

    tried("model", length, changed(model()), path, used)


@pytest.mark.parametrize("length", LENGTHS)
def test_histories(length: int, tmp_path: Path) -> None:
    tried("histories", length, changed(histories()), tmp_path / "histories.json", lambda: read_histories(tmp_path))


def journal(path: Path) -> bytes:
    """Return a journal of three steps."""
    path.unlink(missing_ok=True)
    kept = Journal(path, "0123")
    for number in range(3):
        assert steps(kept, number) == [number, 0.5]
    kept.close()
    return path.read_bytes()


def steps(kept: Journal, number: int) -> list[float]:
    found: list[float] = kept.step(f"fit {number}", lambda: [number, 0.5], lambda found: found, lambda known: known)
    return found


@pytest.mark.parametrize("length", LENGTHS)
def test_a_journal_that_was_changed_is_begun_anew_from_there(length: int, tmp_path: Path) -> None:
    path = tmp_path / ".improve.jsonl"
    whole = journal(path)
    lines = whole.splitlines(keepends=True)

    @st.composite
    def edited(draw: st.DrawFn) -> bytes:
        number = draw(st.integers(0, len(lines) - 1))
        line = draw(changed(lines[number].decode())) + b"\n"
        some = [*lines[:number], line, *lines[number + 1 :]]
        content = b"".join(draw(st.permutations(some)) if draw(st.integers(0, 5)) == 0 else some)
        return spoilt(draw, content) if draw(st.booleans()) else content

    def gone_on() -> None:
        kept = Journal(path, "0123")
        assert [steps(kept, number) for number in range(3)] == [[number, 0.5] for number in range(3)]
        kept.close()
        assert not path.exists() or path.read_bytes() == whole  # of other steps it is no help

    tried("journal", length, edited(), path, gone_on)
