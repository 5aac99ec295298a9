"""Runs a tournament: what is missing is done, what is there is taken, all of it is ranked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import numpy.typing as npt

from fricmodels.arrays import Mask
from fricmodels.errors import FricmodelsError, InputError
from fricmodels.tournament.config import Config, read_config
from fricmodels.tournament.execution import EXECUTORS, results
from fricmodels.tournament.histories import Collected
from fricmodels.tournament.jobs import Job, Row, as_shown
from fricmodels.tournament.leaderboard import Leaderboard, standing
from fricmodels.tournament.listed import Jobs
from fricmodels.tournament.origin import write_origin
from fricmodels.tournament.planning import Plan, plan
from fricmodels.tournament.store import Store

Report = Callable[[int, int, Job, Row], None]
Keys = npt.NDArray[np.uint8]

_AT_ONCE = 500
"""Rows that are held while the leaderboard is made."""


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
        config, document = read_config(config)
    else:
        document = None
    ready = planned or plan(config, directory or ".", document=document)
    target = Path(out)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{target}: cannot be made a directory: {error.strerror}") from None
    with Store(target) as store:
        keys, wanted = _looked_up(store, ready.jobs, retry)
        missing = ready.jobs.only(np.flatnonzero(wanted))
        done = len(ready.jobs) - len(missing)
        how = {"executor": executor, "processes": processes or config.jobs, "scheduler": scheduler}
        outcomes = results(missing, timeout=config.timeout, **how)  # type: ignore[arg-type]
        try:
            with closing(outcomes):  # type: ignore[type-var]
                for job, row in outcomes:
                    store.put(job.key, row)
                    done += 1
                    if report is not None:
                        report(done, len(ready.jobs), job, row)
        except KeyboardInterrupt:
            raise Interrupted(
                f"stopped after {done} of {len(ready.jobs)} fits, all kept in {store.path}; "
                "the same command goes on from there"
            ) from None
        with store.unchanged():
            board = _written(target, store, ready.jobs, keys, config.ranking)
    write_origin(target, ready, config_file)
    return board


def _looked_up(store: Store, jobs: Jobs, retry: bool) -> tuple[Keys, Mask]:
    """Return the key of every job, and whether it has to be done."""
    keys, wanted = np.zeros((len(jobs), 32), np.uint8), np.ones(len(jobs), np.bool_)
    for numbers in _batches(len(jobs)):
        texts = [jobs[number].key for number in numbers]
        keys[numbers.start : numbers.stop] = [[*bytes.fromhex(text)] for text in texts]
        known = store.get(texts)
        for number, text in zip(numbers, texts, strict=True):
            wanted[number] = text not in known or (retry and known[text]["status"] != "ok")
    return keys, wanted


def _written(target: Path, store: Store, jobs: Jobs, keys: Keys, rank_by: str) -> Leaderboard:
    """Rank the kept rows of all jobs and write them and the histories, in batches; return the leaderboard."""
    bad, figure = np.zeros(len(jobs), np.bool_), np.zeros(len(jobs))
    for numbers in _batches(len(jobs)):
        texts = [keys[number].tobytes().hex() for number in numbers]
        for number, row in zip(numbers, store.all_of(texts), strict=True):
            bad[number], figure[number] = standing(row, rank_by)
    order, collected = np.lexsort((figure, bad)), Collected()

    def ranked() -> Iterator[Row]:
        for ranks in _batches(len(jobs)):
            texts = [keys[order[rank]].tobytes().hex() for rank in ranks]
            for rank, kept in zip(ranks, store.all_of(texts), strict=True):
                row = {**kept, **jobs.named(int(order[rank]))}
                collected.add(row)
                yield {"rank": rank + 1, **as_shown(row)}

    board = Leaderboard.written(target, ranked(), len(jobs))
    collected.write(target)
    return board


def _batches(count: int) -> Iterator[range]:
    return (range(start, min(start + _AT_ONCE, count)) for start in range(0, count, _AT_ONCE))
