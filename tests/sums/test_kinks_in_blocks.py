"""Sums of a drive with a coarse encoder: its kinks are those of the recording that the plan was made from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels import sums
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.simulation import simulate
from fricmodels.sums import rows as rows_module
from fricmodels.sums.rows import block_rows
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.problem import WeakFormProblem

LAW, STEP, TRUTH = "coulomb-viscous", 0.002, {"J": 0.003, "K_v": 0.01, "K_c": 0.06}


@pytest.fixture(scope="module")
def coarse(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A leg that a torque without jumps drives, behind 2048 counts a turn."""
    time = STEP * np.arange(9000)
    torque = sum(size * np.sin(2 * np.pi * f * time + f) for f, size in ((1.3, 0.09), (2.9, 0.08), (4.1, 0.05)))
    velocity = simulate(Drive(Model.parse(LAW), TRUTH["J"]), TRUTH, time, np.asarray(torque), substeps=20).velocity
    position = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (velocity[1:] + velocity[:-1]))])
    count = 2 * np.pi / 2048
    table = pd.DataFrame({"time_s": time, "torque_Nm": torque, "position_rad": count * np.round(position / count)})
    path = tmp_path_factory.mktemp("coarse") / "leg.parquet"
    table.to_parquet(path, row_group_size=7001)
    return path


@pytest.fixture(scope="module")
def plan(coarse: Path) -> sums.Plan:
    return sums.plan_for(sums.pilot(coarse), LAW)


def test_the_plan_has_the_kinks_of_its_recording(coarse: Path, plan: sums.Plan) -> None:
    assert plan.kinks > 0.5
    recording, drive = ready(sums.pilot(coarse)), Drive(Model.parse(LAW))
    problem = WeakFormProblem.of(drive, recording, plan.friction, plan.width)
    channels = {name: recording[name] for name in ("time", "torque", "position")}
    rows, begins = block_rows(plan, channels, 0, len(recording))
    own = np.vstack([problem.driving, problem.momentum, problem.columns(drive)[0]])
    _, here, there = np.intersect1d(begins, problem.test_functions.begins, return_indices=True)
    assert len(here) > 0.9 * problem.rows
    size = np.abs(own).max(axis=1, keepdims=True)
    np.testing.assert_allclose(rows[: len(own), here] / size, own[:, there] / size, atol=1e-6)


def test_blocks_change_nothing(coarse: Path, plan: sums.Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sums.of_file(coarse, plan)
    monkeypatch.setattr(rows_module, "_BLOCK", 900)
    cut = sums.of_file(coarse, plan)
    assert cut.rows == whole.rows
    scale = float(np.abs(whole.whole).max())
    np.testing.assert_allclose(cut.stretches, whole.stretches, rtol=1e-9, atol=1e-9 * scale)
    assert sums.solved(cut).parameters["K_c"] == pytest.approx(TRUTH["K_c"], rel=0.03)
