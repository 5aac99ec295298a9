"""A real Dask cluster of two processes on this machine: recordings reach them, one may die, other code is refused."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricmodels.errors import InputError
from fricmodels.tournament import cluster, run
from fricmodels.tournament.config import Config

distributed = pytest.importorskip("distributed", reason="Dask is not installed")
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def dask() -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None
    ) as running:
        yield running


def config(folder: Path, seeds: int = 6) -> Config:
    """Return a tournament of a rig's or simulation's recordings, and of one file by a path that is good only here."""
    time_s = 0.004 * np.arange(1500)
    velocity = 3.0 * np.sin(2.1 * time_s) + 1.5 * np.sin(5.3 * time_s)
    slope = 6.3 * np.cos(2.1 * time_s) + 7.95 * np.cos(5.3 * time_s)
    torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity)
    rows = np.column_stack([time_s, torque, velocity])
    np.savetxt(folder / "arm.csv", rows, delimiter=",", header="time_s,torque_Nm,velocity_rad_s", comments="")
    motor = {
        "model": "coulomb-viscous",
        "parameters": {"K_v": 1e-4, "K_c": 1e-2},
        "inertia": 4.87e-6,
        "amplitude": 0.03,
        "frequency": 39.54,
        "noise_percent": 2,
        "seeds": seeds,
    }
    content = {
        "datasets": [{"name": "motor", "simulate": motor}, {"name": "arm", "files": "arm.csv", "inertia": 0.05}],
        "models": ["coulomb-viscous", "square-root"],
        "estimators": ["rls"],
        "simulate": False,
    }
    return Config.model_validate(content)


def same(board: Any) -> list[dict[str, Any]]:
    return [{**row, "seconds": None} for row in board.rows]


def test_recordings_reach_workers_and_one_that_is_killed_half_way_changes_nothing(
    dask: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The path of the file is relative, and the workers are in another folder."""
    given, killed = config(tmp_path), list[int]()
    monkeypatch.chdir(tmp_path)
    with distributed.Client(dask, set_as_default=False) as client:
        assert set(client.run(os.getcwd).values()) != {str(tmp_path)}
    here = run(given, tmp_path / "here", executor="serial")

    def report(done: int, total: int, *_: Any) -> None:
        if done >= total // 2 and not killed:
            with distributed.Client(dask, set_as_default=False) as client:
                killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    there = run(given, tmp_path / "there", executor="dask", scheduler=dask.scheduler_address, report=report)
    assert len(killed) == 1
    assert same(there) == same(here)
    assert {row["status"] for row in there.rows} == {"ok"}


@pytest.mark.long
def test_recordings_are_sent_again_where_the_only_worker_that_had_them_died(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A second worker joins after the recordings were sent, and the first one dies: with it all that was sent."""
    given, killed, sendings, send = config(tmp_path), list[int](), list[int](), cluster._sent

    def counted(*arguments: Any) -> Any:
        sendings.append(1)
        return send(*arguments)

    monkeypatch.setattr(cluster, "_sent", counted)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None
    ) as one:
        monkeypatch.chdir(tmp_path)

        def report(done: int, total: int, *_: Any) -> None:
            if done >= 1 and not killed:
                with distributed.Client(one, set_as_default=False) as client:
                    killed.append(next(iter(client.run(os.getpid).values())))
                    monkeypatch.chdir(elsewhere)  # where the next worker begins, which has no recordings there
                    one.scale(2)
                    client.wait_for_workers(2, timeout="60s")
                    monkeypatch.chdir(tmp_path)
                os.kill(killed[0], signal.SIGKILL)

        board = run(given, tmp_path / "a", executor="dask", scheduler=one.scheduler_address, report=report)
    assert len(killed) == 1
    assert [row["message"] for row in board.rows if row["status"] != "ok"] == []
    assert len(sendings) == 2, "once more for all jobs that lost them"


@pytest.mark.long
def test_a_result_that_the_scheduler_forgot_is_asked_for_again(
    dask: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first readings of two jobs fail as they do where a worker dies just then; all readings of a third do."""
    given, address, tried, outcome = config(tmp_path, 1), dask.scheduler_address, list[str](), cluster._outcome

    def forgetful(job: Any, result: Any, last: bool) -> Any:
        def forgotten() -> Any:
            raise distributed.client.FutureCancelledError("a key", "scheduler-lost")

        tried.append(job.key)
        keys = list(dict.fromkeys(tried))
        lost = keys.index(job.key) == 2 or (keys.index(job.key) < 2 and tried.count(job.key) == 1)
        return outcome(job, forgotten if lost else result, last)

    monkeypatch.setattr(cluster, "_outcome", forgetful)
    rows = run(given, tmp_path / "a", directory=tmp_path, executor="dask", scheduler=address).rows
    assert sorted(row["status"] for row in rows) == ["crashed", *["ok"] * (len(rows) - 1)]
    (crashed,) = (row for row in rows if row["status"] == "crashed")
    assert "on the cluster: FutureCancelledError" in crashed["message"]
    assert sorted(tried.count(key) for key in set(tried)) == [*[1] * (len(rows) - 3), 2, 2, 3]


def test_a_worker_without_a_plugin_is_named(dask: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given, address = config(tmp_path, 1), dask.scheduler_address
    with monkeypatch.context() as patch:
        patch.setattr(cluster, "distributions", lambda *_: frozenset({"fricmodels-nowhere"}))
        with pytest.raises(InputError, match=r"worker tcp://127.* does not have fricmodels-nowhere; install there"):
            run(given, tmp_path / "a", directory=tmp_path, executor="dask", scheduler=address)
    monkeypatch.setattr(cluster, "digest", lambda _: "other")
    with pytest.raises(InputError, match="has another version of fricmodels"):
        run(given, tmp_path / "b", directory=tmp_path, executor="dask", scheduler=address)


def test_a_scheduler_that_does_not_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_ANSWERS", "1s")
    with pytest.raises(InputError, match=r"the Dask scheduler at tcp://127.0.0.1:9 cannot be used"):
        run(config(tmp_path, 1), tmp_path, directory=tmp_path, executor="dask", scheduler="tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="add --executor dask"):
        run(config(tmp_path, 1), tmp_path, directory=tmp_path, scheduler="tcp://127.0.0.1:9")


def test_files_that_came_along_are_kept_under_their_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    description = '{"kind": "files", "files": ["/far/a/log.csv", "/here/log.csv"], "test_files": []}'
    placed = cluster._placed(description, {"/far/a/log.csv": b"content"})
    assert "/here/log.csv" in placed
    (kept,) = tmp_path.rglob("log.csv")
    assert kept.read_bytes() == b"content"
    assert str(kept) in placed


def test_a_job_has_its_limit_of_time_on_a_cluster_as_well(
    dask: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limit is less than any fit takes: every job is ended, and the workers do the next tournament."""
    given = config(tmp_path, seeds=1)
    given = given.model_copy(update={"models": ("coulomb-viscous",), "datasets": given.datasets[:1]})
    short = given.model_copy(update={"timeout": 1e-3})
    address = dask.scheduler_address
    board = run(short, tmp_path / "short", directory=tmp_path, executor="dask", scheduler=address)
    assert {row["status"] for row in board.rows} == {"timeout"}
    assert all("took longer than 0.001 s" in row["message"] for row in board.rows)
    again = run(given, tmp_path / "again", directory=tmp_path, executor="dask", scheduler=address)
    assert {row["status"] for row in again.rows} == {"ok"}
