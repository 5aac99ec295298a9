"""Logs in which each sample stands in several rows: it is taken once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tests.conftest import INERTIA, LAW, Made

from fricmodels import compare, diagnose, read
from fricmodels.dimension import Motion
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
        recording.with_channels(derived=False, position=recording["position"][held]),
        recording.with_channels(derived=False, velocity=recording.velocity[held]),
        recording.with_channels(derived=False, torque=20.0 * np.round(recording.torque / 20.0)),
    ]
    for each in others:
        assert once_each(each) is each


@pytest.mark.parametrize("channels", [("position", "velocity"), ("position",), ("velocity",)])
def test_a_motion_that_is_told_more_rarely_than_the_torque_is_taken_where_it_is_new(
    made: Made, channels: tuple[str, ...]
) -> None:
    """A motor controller tells it every fifth row of the program that logs the torque.

    Fitted as it stands K_c is off by far more, and of positions alone the fit is refused: the drive stands still in
    four rows of five.
    """
    whole = made(samples=8000)
    held = np.repeat(np.arange(0, 8000, 5), 5)
    told = {"time": whole.time, "torque": whole.torque, **{name: whole[name][held] for name in channels}}
    rows = replace(whole, channels=told, derived=frozenset())
    found = once_each(rows)
    assert found.provenance["polled"] == {"rows": 8000, "samples": 1600, "of": "motion"}
    for name in channels:
        np.testing.assert_array_equal(found[name], whole[name][::5])
    middle = slice(1, -1)  # the mean of the torque is centred, whatever the number of rows
    weights = np.array([0.25, 0.75, 1.0, 1.0, 1.0, 0.75, 0.25]) / 5.0  # trapezoids; half of the outer ones
    expected = np.convolve(whole.torque, weights, "same")[::5]
    np.testing.assert_allclose(found.torque[middle], expected[middle], rtol=1e-9, atol=1e-12)
    fit = compare(found, "coulomb-viscous", INERTIA).estimate
    assert fit.parameters["K_c"] == pytest.approx(LAW["K_c"], rel=0.002)
    (said,) = (one for one in summary(found, INERTIA).findings if one.kind == "repeated-samples")
    assert "of 8000 rows 1600 are taken, with the mean of the torque about each" in said.text


@pytest.mark.parametrize("counts", [1, 3])
def test_a_coarse_encoder_at_a_steady_speed_was_not_polled(counts: int) -> None:
    """Its counts come as evenly, a few at once."""
    time = 1e-3 * np.arange(3000)
    position = 0.01 * np.floor(np.arange(3000) / 4) * counts
    channels = {"time": time, "torque": np.sin(time), "position": position}
    steady = Recording("steady", Motion.ROTARY, channels, np.zeros(3000, dtype=np.int64))
    finer = position + 0.01 * np.arange(3000) * (np.arange(3000) < 8)  # its grid is told by single counts
    for each in (steady, steady.with_channels(derived=False, position=finer)):
        assert once_each(each) is each


def test_of_a_short_log_every_row_is_needed(made: Made) -> None:
    recording = made(samples=900)
    held = np.repeat(np.arange(0, 900, 5), 5)
    polled = recording.with_channels(
        derived=False, position=recording["position"][held], velocity=recording.velocity[held]
    )
    assert once_each(polled) is polled


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
