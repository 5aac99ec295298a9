"""Several files as one dataset, with another joint's motion, in a tournament: the same row as from one file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.tournament import load_config, run
from fricmodels.tournament.sources import sources

DATASET = """
  - name: {name}
    files: {files}
    inertia: 2.0
    columns: {{other: {{j2_acceleration: "ddq2 [rad/s^2]"}}}}
"""
MODEL = "coulomb-viscous+other(j2_acceleration)"


@pytest.fixture
def folder(made: Callable[..., Recording], tmp_path: Path) -> Path:
    recording = made(samples=4000)
    pull = np.sin(3.1 * recording.time)
    channels = {"time_s": "time", "velocity_rad_s": "velocity", "position_rad": "position"}
    table = pd.DataFrame({name: recording[channel] for name, channel in channels.items()})
    table = table.assign(torque_Nm=recording.torque + 0.5 * pull, ddq2=pull, run=np.arange(4000) // 2000)
    table.to_csv(tmp_path / "whole.csv", index=False)
    for number, part in table.groupby("run"):
        part.drop(columns="run").to_csv(tmp_path / f"day{number}.csv", index=False)
    return tmp_path


def config(folder: Path, datasets: str) -> Path:
    file = folder / "config.yaml"
    file.write_text(f"datasets:{datasets}models: {MODEL}\nestimators: [batch, ekf, rls]\nsimulate: false\n")
    return file


def test_files_together_give_the_row_of_one_file(folder: Path) -> None:
    together = DATASET.format(name="days", files="'day*.csv'") + "    together: true\n"
    loaded = load_config(config(folder, together + DATASET.format(name="whole", files="whole.csv")))
    board = run(loaded, folder / "out", executor="serial", directory=folder)
    rows = {(row["estimator"], row["dataset"]): row for row in board.rows}
    assert len(rows) == 6
    for estimator in ("batch", "ekf", "rls"):
        days, whole = rows[estimator, "days"], rows[estimator, "whole"]
        assert days["status"] == "ok", days["message"]
        assert days["parameters"] == whole["parameters"]
        assert days["held_out_rms_torque_error_percent"] == whole["held_out_rms_torque_error_percent"]
    assert rows["batch", "days"]["parameters"]["other(j2_acceleration).c"] == pytest.approx(0.5, abs=0.01)
    assert rows["ekf", "days"]["parameters"]["other(j2_acceleration).c"] == pytest.approx(0.5, abs=0.05)


def test_apart_each_file_is_a_dataset(folder: Path) -> None:
    listed, _ = sources(load_config(config(folder, DATASET.format(name="days", files="'day*.csv'"))), folder)
    assert [source.dataset for source in listed] == ["days/day0", "days/day1"]


def test_together_goes_with_files(folder: Path) -> None:
    text = "\n  - {rig: a.yaml, together: true}\n"
    with pytest.raises(InputError, match="'together' goes with 'files'"):
        load_config(config(folder, text))


def test_files_that_are_all_fitted_are_no_test(folder: Path) -> None:
    text = "\n  - {name: days, files: ['day*.csv'], together: true, test_files: [day1.csv]}\n"
    with pytest.raises(InputError, match="takes no part in the fit"):
        sources(load_config(config(folder, text)), folder)


def test_a_test_file_has_no_offset_of_a_run_that_was_fitted(folder: Path, made: Callable[..., Recording]) -> None:
    """The test file is a third day, with a zero of its own, though it is the first run of its file."""
    own = made(samples=6000)
    table = pd.DataFrame({"time_s": own.time, "velocity_rad_s": own.velocity, "torque_Nm": own.torque})
    for day, offset in enumerate((3.0, -2.0, 0.0)):
        part = table.iloc[2000 * day : 2000 * (day + 1)]
        part.assign(torque_Nm=part.torque_Nm + offset).to_csv(folder / f"zeroed{day}.csv", index=False)
    file = folder / "zeroed.yaml"
    file.write_text(
        "datasets:\n  - {name: days, files: [zeroed0.csv, zeroed1.csv], together: true, inertia: 2.0, "
        "test_files: [zeroed2.csv, zeroed1.csv]}\n"
        "models: [coulomb-viscous, coulomb-viscous+run-offset]\nestimators: [batch]\nsimulate: false\n"
    )
    board = run(load_config(file), folder / "out", executor="serial", directory=folder)
    plain, with_offsets = sorted(board.rows, key=lambda row: len(row["model"]))
    assert (plain["status"], with_offsets["status"]) == ("ok", "ok")
    fit = with_offsets["rms_torque_error_percent"]
    assert with_offsets["held_out_rms_torque_error_percent"] < 1.5 * fit < plain["rms_torque_error_percent"]
