"""Logs in which each sample stands in several rows: it is taken once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tests.conftest import INERTIA, LAW, Made

from fricmodels import compare, diagnose, read
from fricmodels.logcheck.summary import summary
from fricmodels.recording import Recording
from fricmodels.signals.polled import once_each


def written(recording: Recording, times: int | tuple[int, ...]) -> Recording:
    """Return a recording each sample of which stands in so many rows, or in turn in so many."""
    count = np.resize(times, len(recording))
    index = np.repeat(np.arange(len(recording)), count)
    every = {name: values[index] for name, values in recording.channels.items()}
    time = recording.interval / np.mean(count) * np.arange(len(index))
    return replace(recording, channels={**every, "time": time}, run=recording.run[index])


@pytest.mark.parametrize("times", [2, 4, (3, 4)])
def test_the_samples_are_those_that_were_written(made: Made, times: int | tuple[int, ...]) -> None:
    recording = made(samples=2000)
    found = once_each(written(recording, times))
    for name in ("torque", "position", "velocity"):
        np.testing.assert_array_equal(found[name], recording[name])
    assert found.provenance["polled"] == {"rows": int(np.resize(times, 2000).sum()), "samples": 2000}


def test_at_rest_the_rows_go_on(made: Made) -> None:
    recording = made(samples=2000)
    still = {
        name: np.where(np.arange(2000) > 1500, values[1500], values) for name, values in recording.channels.items()
    }
    found = once_each(written(replace(recording, channels={**still, "time": recording.time}), 3))
    assert len(found) == 2000


def test_what_is_a_sample_stays(made: Made) -> None:
    """A torque that is held, a position that is polled by itself, coarse channels, and any usual log."""
    recording = made(samples=2000)
    held = np.repeat(np.arange(0, 2000, 4), 4)
    others = [
        recording,
        recording.with_channels(derived=False, torque=recording.torque[held]),
        recording.with_channels(derived=False, position=recording["position"][held], velocity=recording.velocity[held]),
        recording.with_channels(derived=False, torque=20.0 * np.round(recording.torque / 20.0)),
    ]
    for each in others:
        assert once_each(each) is each


def test_a_file_of_such_rows_says_so_and_gives_the_true_friction(made: Made, tmp_path: Path) -> None:
    rows = written(made(samples=4000), (3, 4))
    columns = {"time_s": rows.time, "torque_Nm": rows.torque, "position_rad": rows["position"]}
    pd.DataFrame(columns).to_csv(tmp_path / "polled.csv", index=False)
    recording = read(tmp_path / "polled.csv")
    (said,) = (one for one in summary(recording, INERTIA).findings if one.kind == "repeated-samples")
    assert "of 14000 rows 4000 are taken" in said.text
    fit = compare(recording, "coulomb-viscous", INERTIA).estimate
    assert fit.parameters["K_c"] == pytest.approx(LAW["K_c"], rel=0.02)


@pytest.mark.long
def test_rows_that_were_not_read_from_a_file_have_an_answer_too(made: Made) -> None:
    """There most intervals have no motion, and no wave that is too fast for the rows can be told."""
    rows = written(made(samples=4000), 4)
    channels = {name: rows[name] for name in ("time", "torque", "position")}
    assert diagnose(replace(rows, channels=channels), "coulomb-viscous", INERTIA).verdict
