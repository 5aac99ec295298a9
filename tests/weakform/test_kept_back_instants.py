"""A jump that lies in a block that was kept back: only the block tells when."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.conftest import INERTIA, LAW, Made

from fricmodels.diagnosis import compare
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.kept_back_instants import told_by_kept_back

MODEL, KEY = "coulomb-viscous+step-change", "step-change.t_0"


def blocks_kept_back(recording: Recording) -> list[tuple[float, float]]:
    """Return where each block begins and ends that a comparison keeps back."""
    time = compare(recording, "coulomb-viscous", INERTIA).test.time
    cuts = np.flatnonzero(np.diff(time) > 2 * recording.interval)
    return [(float(part[0]), float(part[-1])) for part in np.split(time, cuts + 1)]


@pytest.mark.parametrize("place", [0.1, 0.5, 0.9])
def test_a_jump_in_a_block_that_was_kept_back_is_found_there(made: Made, place: float) -> None:
    """The middle of the block blames the model for what the jump does in half of it."""
    blocks = blocks_kept_back(made())
    begin, end = blocks[len(blocks) // 2]
    instant = begin + place * (end - begin)
    recording = made(MODEL, {"step-change.c": 0.8, "step-change.d": 0.0, KEY: instant})
    assert blocks_kept_back(recording) == blocks
    comparison = compare(recording, MODEL, INERTIA)
    # Within the half width of the filter, or a reversal, of the truth.
    assert comparison.estimate.parameters[KEY] == pytest.approx(instant, abs=0.05)
    assert comparison.estimate.told_by_kept_back == (KEY,)
    errors = comparison.errors
    assert errors.held_out_percent < 1.5 * errors.percent


def test_a_jump_that_was_fitted_is_told_by_the_fit(made: Made) -> None:
    blocks = blocks_kept_back(made())
    instant = 0.5 * (blocks[1][1] + blocks[2][0])
    recording = made(MODEL, {"step-change.c": 0.8, "step-change.d": 0.0, KEY: instant})
    comparison = compare(recording, MODEL, INERTIA)
    assert comparison.estimate.parameters[KEY] == pytest.approx(instant, abs=0.05)
    assert comparison.estimate.told_by_kept_back == ()


def test_runs_tell_it_in_the_order_of_their_times(made: Made) -> None:
    """The later part of a record is its first run; what lies between 7 and 9 s is kept back of both."""
    one = made(MODEL, {"step-change.c": 0.8, "step-change.d": 0.0, KEY: 8.6})
    order = np.argsort(one.time < 8.0, kind="stable")
    turned = one.select(order)
    whole = replace(turned, run=(turned.time < 8.0).astype(np.int64)).remembering()
    fitted = whole.select((whole.time < 7.0) | (whole.time > 9.0))
    parameters = {**LAW, "J": INERTIA, "step-change.c": 0.8, "step-change.d": 0.0, KEY: 8.0}
    told = told_by_kept_back(Drive(Model.parse(MODEL), INERTIA, one.motion), fitted, parameters, {})
    assert told[KEY] == pytest.approx(8.6, abs=0.05)


def test_a_gap_in_which_nothing_was_recorded_tells_nothing(made: Made) -> None:
    """Then any instant in it is as good, and its middle is off by half of it at the most."""
    recording = made(MODEL, {"step-change.c": 0.8, "step-change.d": 0.0, KEY: 8.3})
    recording = recording.select((recording.time < 8.0) | (recording.time > 9.0))
    _, found = estimate(Drive(Model.parse(MODEL), INERTIA, recording.motion), recording)
    assert found.parameters[KEY] == pytest.approx(8.5, abs=0.01)
    assert found.told_by_kept_back == ()


@pytest.mark.parametrize("beyond", [-0.03, 0.04])
def test_a_jump_that_was_fitted_just_outside_of_a_block_is_sought_within(made: Made, beyond: float) -> None:
    """No row reaches into the block: one near its end may be fitted past it. How far off it may be tells its error."""
    whole = made(MODEL, {"step-change.c": 0.8, "step-change.d": 0.0, KEY: 8.3}).remembering()
    fitted = whole.select((whole.time < 7.0) | (whole.time > 9.0))
    drive = Drive(Model.parse(MODEL), INERTIA, whole.motion)
    at = {
        **LAW,
        "J": INERTIA,
        "step-change.c": 0.8,
        "step-change.d": 0.0,
        KEY: 9.0 + beyond if beyond > 0 else 7.0 + beyond,
    }
    assert told_by_kept_back(drive, fitted, at, {KEY: 0.5})[KEY] == pytest.approx(8.3, abs=0.05)
    assert told_by_kept_back(drive, fitted, at, {KEY: 0.001}) == {}
