"""A tournament holds what is open: neither jobs nor rows take room in memory, however many there are."""

from __future__ import annotations

import gc
import json
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricmodels.fit import Status
from fricmodels.tournament import execution, leaderboard, plan, run
from fricmodels.tournament.config import Config
from fricmodels.tournament.jobs import Job, Row
from fricmodels.tournament.leaderboard import Leaderboard

SIMULATED = {
    "model": "coulomb-viscous",
    "parameters": {"K_v": 1e-4, "K_c": 1e-2},
    "inertia": 4.87e-6,
    "amplitude": [0.02, 0.03],
    "frequency": 39.54,
    "noise_percent": [1, 2],
}


def config(seeds: int) -> Config:
    datasets = [{"name": "motor", "simulate": {**SIMULATED, "seeds": seeds}}]
    content = {"datasets": datasets, "models": ["coulomb-viscous", "square-root"], "estimators": ["batch", "rls"]}
    return Config.model_validate({**content, "simulate": False})


def quick(job: Job) -> Row:
    """Return the row of a job without its fit; every tenth fails, errors come in sevens."""
    number = int(job.key[:8], 16)
    row = job.row(Status.FAILED if number % 10 == 0 else Status.OK, seconds=0.0)
    row["held_out_rms_torque_error_percent"] = None if number % 10 == 0 else float(number % 7)
    return row


def test_jobs_are_every_combination_and_made_alike_each_time() -> None:
    jobs = plan(config(3)).jobs
    assert len(jobs) == 2 * 2 * 2 * 2 * 3
    assert len({job.key for job in jobs}) == len(jobs)
    assert jobs[5] == list(jobs)[5] == jobs[5 - len(jobs)]
    seen = {(job.model, job.estimator, job.source.description) for job in jobs}
    assert len(seen) == len(jobs)
    for number, job in enumerate(jobs):
        named = {"estimator": job.title, "dataset": job.source.dataset, "tags": job.source.tags}
        assert jobs.named(number) == named
    grouped = [jobs[number].group for group, numbers in jobs.groups() for number in numbers if group]
    assert grouped == [job.group for job in jobs]
    with pytest.raises(IndexError):
        jobs[len(jobs)]


def test_some_jobs_are_those_with_their_numbers() -> None:
    jobs = plan(config(3)).jobs
    some = jobs.only(np.array([1, 13, 14, 40]))
    assert [job.key for job in some] == [jobs[number].key for number in (1, 13, 14, 40)]
    assert [list(numbers) for _, numbers in some.groups()] == [[0], [1, 2], [3]]
    assert some.only(np.array([2]))[0] == jobs[14]


@pytest.fixture
def no_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(execution, "execute", quick)


@pytest.mark.usefixtures("no_fits")
def test_rows_in_the_file_are_those_in_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    held = run(config(20), tmp_path / "held", executor="serial")
    monkeypatch.setattr(leaderboard, "HELD", 0)
    kept = run(config(20), tmp_path / "kept", executor="serial")
    texts = [(tmp_path / name / "leaderboard.json").read_bytes() for name in ("held", "kept")]
    assert texts[0] == texts[1]
    document: dict[str, Any] = {"schema": leaderboard.SCHEMA, "rows": list(held.rows)}
    assert texts[0].decode() == json.dumps(document, indent=1, ensure_ascii=False) + "\n"
    assert isinstance(held.rows, tuple)
    assert not isinstance(kept.rows, tuple)
    (tmp_path / "kept" / "leaderboard.json").unlink()
    assert kept.rows == held.rows
    assert kept.rows[-3:] == held.rows[-3:]
    assert kept.summary() == held.summary()
    assert kept.failures == held.failures
    assert held.rows == Leaderboard.ranked(held.rows).rows


@pytest.mark.usefixtures("no_fits")
def test_a_run_that_grows_does_what_is_missing(tmp_path: Path) -> None:
    run(config(2), tmp_path, executor="serial")
    done: list[str] = []
    run(config(4), tmp_path, executor="serial", report=lambda *state: done.append(state[2].key))
    small, large = plan(config(2)).jobs, plan(config(4)).jobs
    assert set(done) == {job.key for job in large} - {job.key for job in small}


@pytest.mark.usefixtures("no_fits")
@pytest.mark.long
def test_memory_does_not_grow_with_the_jobs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(leaderboard, "HELD", 0)

    def most(seeds: int) -> int:
        gc.collect()
        tracemalloc.start()
        try:
            board = run(config(seeds), tmp_path / str(seeds), executor="serial")
            assert len(board.rows) == 16 * seeds
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    first = most(35)
    assert most(95) - first < 16 * 60 * 300
