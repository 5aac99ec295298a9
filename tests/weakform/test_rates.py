"""Runs of other lengths and rates: what is added never makes a fit less certain, as it did by narrow or ill-weighed
rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis.comparison import compare
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.weakform.rates import relative_intervals, weights_of_rows

INERTIA = 0.05
TRUE = {"K_v": 0.2, "K_c": 1.0}


def run(rate: float, seconds: float, seed: int, velocity_noise: float, torque_noise: float) -> Recording:
    """Return a multisine of a clean drive; noise in shares of the RMS velocity and torque."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * rate)) / rate
    waves = 2.0 * np.pi * np.outer([0.31, 0.73, 1.17, 2.3], time) + rng.uniform(0.0, 6.0, (4, 1))
    torque = 2.0 * np.sin(waves).sum(axis=0)
    found = simulate(Drive(Model.parse("coulomb-viscous"), INERTIA), TRUE, time, torque, substeps=int(2000 / rate))
    return found.with_channels(
        velocity=found.velocity + velocity_noise * np.std(found.velocity) * rng.standard_normal(len(time)),
        torque=torque + torque_noise * np.std(torque) * rng.standard_normal(len(time)),
    )


def together(*runs: Recording) -> Recording:
    ends = np.cumsum([0.0, *(part.time[-1] + 1.0 for part in runs)])
    shifted = [part.with_channels(time=part.time + end) for part, end in zip(runs, ends[:-1], strict=True)]
    channels = {name: np.concatenate([part[name] for part in shifted]) for name in ("time", "torque", "velocity")}
    return replace(
        runs[0], channels=channels, run=np.repeat(np.arange(len(runs)), [len(part) for part in runs]), origin=None
    )


@pytest.mark.parametrize("noise", [(0.03, 0.01), (0.001, 0.05), (0.01, 0.05)])
@pytest.mark.parametrize(
    "other", [(1000.0, 0.5), (1000.0, 2.0), (50.0, 20.0)], ids=["half a second", "two seconds", "slow"]
)
def test_a_run_that_is_added_makes_a_fit_hardly_less_certain(
    other: tuple[float, float], noise: tuple[float, float]
) -> None:
    alone = run(1000.0, 20.0, 7, *noise)
    both = together(alone, run(*other, 99, *noise))
    before, after = (compare(each, "coulomb-viscous", INERTIA).estimate for each in (alone, both))
    for key, true in TRUE.items():
        assert after.standard_errors[key] < 1.35 * before.standard_errors[key]
        assert abs(after.parameters[key] - true) < 3.0 * after.standard_errors[key]


def test_a_row_counts_by_what_it_is_expected_to_leave() -> None:
    relative, no, one = np.array([1.0, 1.0, 20.0]), np.zeros(3), np.ones(3)
    assert weights_of_rows(relative, one, no, 0.0) == pytest.approx([1.0, 1.0, 1.0])
    assert weights_of_rows(relative, no, one, 0.0) == pytest.approx([1.0, 1.0, 1 / 20])
    assert weights_of_rows(relative, no, no, 0.0) == pytest.approx([1.0, 1.0, 1 / 20])
    assert weights_of_rows(relative, 3.0 * one, 4.0 * one, 0.0) == pytest.approx([1.0, 1.0, 5 / np.hypot(3, 80)])
    assert weights_of_rows(one, np.array([3.0, 3.0, 0.4]), no, 0.3) == pytest.approx([1.0, 1.0, np.hypot(3, 0.3) / 0.5])


def test_rows_are_those_of_one_rate_where_runs_differ_by_little() -> None:
    slower = run(900.0, 2.0, 1, 0.0, 0.0)
    recording = together(run(1000.0, 2.0, 1, 0.0, 0.0), slower)
    assert np.all(relative_intervals(recording) == 1.0)
    assert compare(recording, "coulomb-viscous", INERTIA).problem.test_functions.counts is None


def test_intervals_are_those_of_each_run() -> None:
    recording = together(run(1000.0, 4.0, 1, 0.0, 0.0), run(100.0, 4.0, 2, 0.0, 0.0))
    assert relative_intervals(recording)[:4000] == pytest.approx(1.0)
    assert relative_intervals(recording)[4000:] == pytest.approx(10.0)


def test_intervals_of_two_lengths_by_turns_are_one_rate() -> None:
    """The median of some runs is the one, of others the other."""
    rng = np.random.default_rng(4)
    runs = []
    for seed in range(6):
        fine = run(1000.0, 2.0, seed, 0.0, 0.0)
        runs.append(fine.select(np.cumsum(rng.choice([1, 2], 1200, p=[0.5, 0.5]))[:1200]))
    recording = together(*runs)
    medians = [np.median(np.diff(recording.time[recording.run == number])) for number in recording.run_numbers]
    assert max(medians) > 1.5 * min(medians)
    assert np.all(relative_intervals(recording) == 1.0)
