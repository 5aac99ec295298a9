"""Where a model fails: the regimes cover the motion, and an error is found where it was put."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.diagnosis import ready
from fricmodels.diagnosis.where import in_words, regimes, where
from fricmodels.dimension import Motion
from fricmodels.recording import Recording

Made = Callable[..., Recording]

PARTITIONS = [
    ("rest", "forward", "backward"),
    ("rest", "low speed", "mid speed", "high speed"),
    ("rest", "accelerating", "decelerating"),
    ("position: low", "position: middle", "position: high"),
    ("time: early", "time: middle", "time: late"),
]


@pytest.fixture(scope="module")
def prepared(made: Made) -> Recording:
    return ready(made(samples=4000))


@pytest.fixture(scope="module")
def stopping() -> Recording:
    """Two moves forward and back with rests between them."""
    time = np.arange(4000) * 1e-3
    phase = (time * 2) % 2
    velocity = np.where(phase < 1, np.sin(2 * np.pi * phase), 0.0)
    rng = np.random.default_rng(0)
    channels = {"time": time, "torque": np.sin(time), "velocity": velocity + 1e-4 * rng.standard_normal(4000)}
    return ready(Recording("stops", Motion.ROTARY, channels, np.zeros(4000, dtype=np.int64)))


@pytest.mark.parametrize("names", PARTITIONS, ids=lambda names: str(names[-1]))
def test_regimes_of_one_kind_cover_every_sample_once(prepared: Recording, names: tuple[str, ...]) -> None:
    masks = regimes(prepared)
    assert np.all(sum(masks[name].astype(int) for name in names) == 1)
    rows = {row.regime: row for row in where(np.random.default_rng(0).normal(size=len(prepared)), prepared)}
    shares = [rows[name].share_of_squared_error for name in names if name in rows]
    assert sum(shares) == pytest.approx(1.0)
    assert sum(rows[name].samples for name in names if name in rows) == len(prepared)


def test_rest_breakaway_and_reversal_are_apart(stopping: Recording) -> None:
    masks = regimes(stopping)
    assert 0.4 < np.mean(masks["rest"]) < 0.6
    assert np.any(masks["breakaway"])
    assert np.any(masks["reversal"])
    together = sum(masks[name].astype(int) for name in ("rest", "breakaway", "reversal"))
    assert np.max(together) == 1


def test_starts_are_no_reversals_where_no_run_turns_back() -> None:
    """Two commands from rest, one each way, as in two files: what follows is the error right after starts."""
    rng = np.random.default_rng(0)
    time = np.arange(600) * 1e-2
    course = np.where(time < 0.5, 0.0, 5.0 * (1.0 - np.exp(-4.0 * np.maximum(time - 0.5, 0.0))))
    velocity = np.concatenate([course, -course]) + 0.01 * rng.standard_normal(1200)
    torque = np.repeat([2.0, -2.0], 600) * np.tile(time >= 0.5, 2)
    channels = {"time": np.concatenate([time, time + 10.0]), "torque": torque, "velocity": velocity}
    masks = regimes(ready(Recording("steps", Motion.ROTARY, channels, np.repeat([0, 1], 600))))
    assert "reversal" not in masks
    assert np.any(masks["start"] | masks["breakaway"])
    assert in_words("start") == "right after starts"


def test_noise_about_rest_is_no_direction() -> None:
    """A drive slows down and rests; neighbouring counts make its velocity there."""
    rng = np.random.default_rng(0)
    velocity = np.maximum(5.0 - 2.5e-3 * np.arange(3000), 0.0) + 0.05 * rng.standard_normal(3000)
    channels = {"time": np.arange(3000) * 1e-3, "torque": 1.0 + 0.1 * velocity, "velocity": velocity}
    masks = regimes(ready(Recording("ramp", Motion.ROTARY, channels, np.zeros(3000, dtype=np.int64))))
    assert not {"forward", "backward"} & set(masks)


@pytest.mark.parametrize("regime", ["backward", "high speed", "time: late", "position: low", "reversal"])
def test_an_error_is_found_where_it_was_put(prepared: Recording, regime: str) -> None:
    mask = regimes(prepared)[regime]
    error = 0.01 * np.random.default_rng(1).normal(size=len(prepared)) + mask
    rows = {row.regime: row for row in where(error, prepared)}
    assert rows[regime].share_of_squared_error > 0.99
    assert rows[regime].rms_torque_error == pytest.approx(1.0, abs=0.02)
    first = where(error, prepared)[0]
    assert first.share_of_squared_error - first.share_of_samples >= 0.99 - np.mean(mask) - 1e-9


def test_no_error_has_no_place(prepared: Recording) -> None:
    assert all(row.share_of_squared_error == 0 for row in where(np.zeros(len(prepared)), prepared))


def test_load_and_temperature_have_regimes_where_they_are_measured(prepared: Recording) -> None:
    count = len(prepared)
    more = prepared.with_channels(load_torque=np.linspace(-1, 1, count), temperature=np.linspace(20, 60, count))
    names = set(regimes(more)) - set(regimes(prepared))
    assert names == {"load: light", "load: medium", "load: heavy"} | {
        f"temperature: {n}" for n in ("cold", "warm", "hot")
    }
    even = prepared.with_channels(temperature=np.full(count, 20.0))
    assert set(regimes(even)) == set(regimes(prepared))


def test_further_channels_and_runs_are_places_too(made: Made) -> None:
    own = made(samples=4000)
    other = np.sin(3.1 * own.time)
    run = np.arange(4000) // 1000
    channels = {**own.channels, "other.j2_acceleration": other}
    prepared = ready(Recording("two", Motion.ROTARY, channels, run, provenance={"runs": {3: "friday.csv"}}))
    found = regimes(prepared)
    masks = [found[f"j2_acceleration: {name}"] for name in ("low", "middle", "high")]
    assert np.array_equal(np.sum(masks, axis=0), np.ones(4000))
    assert np.array_equal(found["run: friday.csv"], run == 3)
    part = prepared.remembering().select(run != 1)
    assert np.count_nonzero(regimes(part)["run: friday.csv"]) == 1000
    error = np.where(other > 0.9, 1.0, 0.0)
    assert where(error, prepared)[0].regime == "j2_acceleration: high"
