"""Topics of a robot that were merged into one table: each channel in rows of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels import compare, read
from fricmodels.errors import InputError
from fricmodels.readers.joined import joined, stands_apart
from fricmodels.recording import Recording

Made = Callable[..., Recording]


@pytest.fixture
def apart(made: Made, tmp_path: Path) -> tuple[Path, Recording]:
    """Return a table with torque in one half of the rows and motion in the other, and the recording it was made of."""
    whole = made(samples=12_000, noise=0.1)
    torque, motion = whole.select(np.arange(0, 12_000, 2)), whole.select(np.arange(1, 12_000, 2))
    tables = (
        pd.DataFrame({"time_s": torque.time, "torque_Nm": torque.torque}),
        pd.DataFrame({"time_s": motion.time, "position_rad": motion["position"], "velocity_rad_s": motion.velocity}),
    )
    path = tmp_path / "merged.csv"
    pd.concat(tables).sort_values("time_s").to_csv(path, index=False)
    return path, motion


def test_merged_topics_are_refused_and_the_way_out_works(apart: tuple[Path, Recording]) -> None:
    path, motion = apart
    for gaps in (None, "drop", "split"):
        with pytest.raises(InputError, match="--gaps join"):
            read(path, gaps=gaps)  # type: ignore[arg-type]
    found = read(path, gaps="join")
    assert len(found) == len(motion) - 1  # after the last sample of the torque nothing is known of it
    assert found.time == pytest.approx(motion.time[:-1])
    assert found["position"] == pytest.approx(motion["position"][:-1])
    assert "torque interpolated" in found.provenance["gaps"]
    expected = compare(motion, "coulomb-viscous", 2.0).estimate
    fitted = compare(found, "coulomb-viscous", 2.0).estimate
    for key, error in fitted.standard_errors.items():
        assert abs(fitted.parameters[key] - expected.parameters[key]) < 3.0 * error
        assert error < 1.5 * expected.standard_errors[key]


def test_nothing_is_interpolated_across_a_gap_or_beyond_the_ends() -> None:
    time = np.arange(40.0)
    torque = np.where(np.arange(40) % 2 == 0, 3.0 * time, np.nan)
    torque[10:24] = np.nan
    torque[[0, 38]] = np.nan
    velocity = np.where(np.arange(40) % 2 == 1, time, np.nan)
    found, brought = joined({"time": time, "torque": torque, "velocity": velocity}, np.zeros(40, dtype=np.int64))
    assert brought == ["torque"]
    known = np.isfinite(found["torque"])
    assert np.flatnonzero(known).tolist() == [*range(3, 8, 2), *range(25, 36, 2)]
    assert found["torque"][known] == pytest.approx(3.0 * time[known])
    assert not np.isfinite(found["velocity"][::2]).any()


def test_runs_are_joined_each_by_itself() -> None:
    time = np.tile(np.arange(20.0), 2)
    run = np.repeat([0, 1], 20)
    odd = np.arange(40) % 2 == 1
    torque = np.where(odd, np.nan, np.where(run == 0, 1.0, -1.0))
    found, _ = joined({"time": time, "torque": torque, "velocity": np.where(odd, 1.0, np.nan)}, run)
    known = np.isfinite(found["torque"])
    assert known.sum() == 18
    assert np.array_equal(found["torque"][known], np.where(run[known] == 0, 1.0, -1.0))


def test_single_holes_of_one_channel_are_filled_and_the_others_stay(made: Made) -> None:
    whole = made(samples=200)
    channels = {name: values.copy() for name, values in whole.channels.items() if name != "load_torque"}
    channels["torque"][50] = np.nan
    found, brought = joined(channels, whole.run)
    assert brought == ["torque"]
    assert np.isfinite(found["torque"]).all()
    assert np.array_equal(found["velocity"], whole.velocity)
    assert np.array_equal(np.delete(found["torque"], 50), np.delete(whole.torque, 50))


def test_a_channel_that_ends_sooner_is_no_topic_of_its_own() -> None:
    values = np.arange(100.0)
    sooner = np.where(np.arange(100) < 45, values, np.nan)
    assert not stands_apart({"time": values, "torque": sooner, "position": values})
    assert stands_apart({"time": values, "torque": np.where(values % 10 == 0, values, np.nan),
                         "position": np.where(values % 10 == 0, np.nan, values)})  # fmt: skip
