"""Runs a tournament: what is missing is done, what is there is taken, all of it is ranked."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from fricmodels.errors import FricmodelsError, InputError
from fricmodels.tournament.config import Config, load_config
from fricmodels.tournament.execution import EXECUTORS, results
from fricmodels.tournament.histories import write_histories
from fricmodels.tournament.jobs import Job, Row, as_shown
from fricmodels.tournament.leaderboard import Leaderboard
from fricmodels.tournament.origin import write_origin
from fricmodels.tournament.planning import Plan, plan
from fricmodels.tournament.store import Store

Report = Callable[[int, int, Job, Row], None]


class Interrupted(FricmodelsError):
    """The run was stopped from outside; what was done is kept."""

    exit_code = 130


def run(
    config: Config | str | Path,
    out: str | Path,
    *,
    directory: str | Path | None = None,
    executor: str = "local",
    processes: int | None = None,
    retry: bool = False,
    report: Report | None = None,
    planned: Plan | None = None,
    config_file: str | Path | None = None,
    scheduler: str | None = None,
) -> Leaderboard:
    """Run a tournament and write ``leaderboard.json`` into ``out``, and beside it ``run.json``, what it was made of.

    Results are kept in ``out/results.sqlite`` as they come; running again does only what is missing.

    Args:
        config: the tournament, or its YAML file.
        out: directory for the results; made when there is something to write.
        directory: where relative paths in the configuration start; by default where its file is, or here.
        executor: ``local``, ``dask`` or ``serial``.
        processes: how many; ``config.jobs`` or one a core by default.
        retry: do again what did not end well.
        report: called after each job with how many are done, how many there are, the job and its row.
        planned: the result of :func:`plan`, when it is there already.
        config_file: where the configuration was read from, for the record.
        scheduler: address of a running Dask cluster, for the executor ``dask``.

    Raises:
        InputError: for bad input, before anything is written.
        Interrupted: on Ctrl-C; what was done is kept.
    """
    if executor not in EXECUTORS:
        raise InputError(f"unknown executor '{executor}'; known: {', '.join(EXECUTORS)}")
    if scheduler and executor != "dask":
        raise InputError(f"a scheduler goes with the executor dask, not with {executor}: add --executor dask")
    if not isinstance(config, Config):
        directory = Path(config).parent if directory is None else directory
        config = load_config(config)
    ready = planned or plan(config, directory or ".")
    target = Path(out)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{target}: cannot be made a directory: {error.strerror}") from None
    with Store(target) as store:
        rows = store.get(job.key for job in ready.jobs)
        if retry:
            rows = {key: row for key, row in rows.items() if row["status"] == "ok"}
        missing = [job for job in ready.jobs if job.key not in rows]
        done = len(ready.jobs) - len(missing)
        how = {"executor": executor, "processes": processes or config.jobs, "scheduler": scheduler}
        outcomes = results(missing, timeout=config.timeout, **how)  # type: ignore[arg-type]
        try:
            with closing(outcomes):  # type: ignore[type-var]
                for job, row in outcomes:
                    store.put(job.key, row)
                    rows[job.key] = row
                    done += 1
                    if report is not None:
                        report(done, len(ready.jobs), job, row)
        except KeyboardInterrupt:
            raise Interrupted(
                f"stopped after {done} of {len(ready.jobs)} fits, all kept in {store.path}; "
                "the same command goes on from there"
            ) from None
    board = Leaderboard.ranked((_named(rows[job.key], job) for job in ready.jobs), config.ranking)
    board.write(target)
    write_histories(target, board, rows)
    write_origin(target, ready, config_file)
    return board


def _named(row: Row, job: Job) -> Row:
    """Return a kept row under the names that it has in this tournament."""
    return {**as_shown(row), "estimator": job.title, "dataset": job.source.dataset, "tags": dict(job.source.tags)}
