"""Runs that want parameters of their own are said to, with what differs; runs of one drive are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose
from fricmodels.diagnosis.document import comparison_document, document
from fricmodels.diagnosis.runs_apart import runs_apart
from fricmodels.dimension import Motion
from fricmodels.readers import read_together
from fricmodels.recording import Recording
from fricmodels.report.answer import answer
from fricmodels.report.error_words import error_words

INERTIA, VISCOUS, COULOMB, GRAVITY = 0.05, 0.12, 0.8, 0.6


def record(coulomb: list[float], gravity: float = 0.0, name: str = "runs") -> Recording:
    """Return one run for each Coulomb friction, of one drive otherwise."""
    rng, time = np.random.default_rng(1), 0.002 * np.arange(2500)
    runs = []
    for one in coulomb:
        phase = rng.uniform(0.0, 6.0, 2)
        velocity = 3.0 * np.sin(4.0 * time + phase[0]) + 2.0 * np.sin(9.0 * time + phase[1])
        rate = 12.0 * np.cos(4.0 * time + phase[0]) + 18.0 * np.cos(9.0 * time + phase[1])
        position = -0.75 * np.cos(4.0 * time + phase[0]) - 2.0 / 9.0 * np.cos(9.0 * time + phase[1])
        torque = INERTIA * rate + VISCOUS * velocity + one * np.sign(velocity) + gravity * np.sin(position)
        torque += 0.01 * rng.standard_normal(len(time))
        runs.append((time, velocity + 1e-3 * rng.standard_normal(len(time)), torque, position))
    stamps, velocity, torque, position = map(np.concatenate, zip(*runs, strict=True))
    channels = {"time": stamps, "velocity": velocity, "torque": torque, "position": position}
    return Recording(name, Motion.ROTARY, channels, np.repeat(np.arange(len(coulomb)), len(time)))


@pytest.mark.parametrize("coulomb", [[0.8, 2.4], [0.8, 0.8, 2.4], [0.8, 0.8, 2.4, 0.8], [2.4, 0.8, 0.8, 0.8, 0.8]])
def test_runs_of_two_drives_are_apart_whichever_is_kept_back(coulomb: list[float]) -> None:
    found = runs_apart(compare(record(coulomb), "coulomb-viscous", INERTIA))
    assert found is not None
    assert found.runs == len(coulomb)
    assert found.percent is not None
    assert found.together_percent is not None
    assert found.percent < 5.0 < 20.0 < found.together_percent
    [differing] = [one for one in found.parameters if one.key == "K_c"]
    assert (differing.least, differing.greatest) == (pytest.approx(0.8, rel=0.01), pytest.approx(2.4, rel=0.01))
    assert differing.greatest_run == f"run {coulomb.index(2.4)}"


def test_of_very_many_some_are_fitted() -> None:
    comparison = compare(record([0.8, 2.4] * 40), "coulomb-viscous", INERTIA)
    found = runs_apart(comparison)
    assert found is not None
    assert (found.runs, found.fitted) == (80, 32)
    assert {one.key for one in found.parameters} >= {"K_c"}
    assert "The 80 runs are not alike: fitted each by itself 32 of them leave" in error_words(
        comparison_document(comparison)
    )


@pytest.mark.parametrize("runs", [1, 2, 3, 5])
@pytest.mark.parametrize("gravity", [0.0, GRAVITY])
def test_runs_of_one_drive_are_not_whatever_is_missing_in_all(runs: int, gravity: float) -> None:
    comparison = compare(record([COULOMB] * runs, gravity), "coulomb-viscous", INERTIA)
    assert runs_apart(comparison) is None
    assert "not alike" not in error_words(comparison_document(comparison))


def test_files_are_named_with_what_differs_and_what_to_do(tmp_path: Path) -> None:
    paths = [tmp_path / "monday.csv", tmp_path / "tuesday.csv"]
    for path, coulomb in zip(paths, (0.8, 2.4), strict=True):
        one = record([coulomb])
        table = np.column_stack([one[channel] for channel in ("time", "velocity", "torque", "position")])
        np.savetxt(path, table, delimiter=",", header="time_s,velocity_rad_s,torque_Nm,position_rad", comments="")
    found = diagnose(read_together(paths), "coulomb-viscous", INERTIA)
    assert found.verdict == "unknown-effect"
    data = document(found)
    assert "K_c is 0.799 in monday and 2.4 N m in tuesday" in error_words(data)
    said = answer(data)
    assert said.next.startswith("Diagnose each run by itself")
    assert said.command == f"fricmodels diagnose {paths[0]} --model coulomb-viscous --inertia 0.05"
