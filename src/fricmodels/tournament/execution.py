"""Does jobs: in processes that may die or hang, on a Dask cluster, or one after the other right here."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from itertools import chain
from typing import Any

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.fit import Status
from fricmodels.tournament.cluster import ADDRESS, Results, on_cluster
from fricmodels.tournament.jobs import Group, Job, Row, execute
from fricmodels.tournament.listed import Jobs

EXECUTORS = ("local", "dask", "serial")
_UNGUARDED = (
    "the processes of the tournament cannot start; in a script, which each of them imports, put run(…) under "
    "if __name__ == '__main__': or pass executor='serial'"
)


def results(
    jobs: Jobs, *, executor: str, processes: int | None, timeout: float, scheduler: str | None = None
) -> Results:
    """Do the jobs and yield each with its row, as they finish.

    Args:
        jobs: in an order in which those that share compiled code stand together.
        executor: ``local`` processes, ``dask``, or ``serial``: here, without a time limit.
        processes: how many; one a core by default.
        timeout: seconds for one job.
        scheduler: address of a running Dask cluster; that of ``DASK_SCHEDULER_ADDRESS``, or else one that is started.

    Raises:
        InputError: for an unknown executor, or Dask where it is not installed.
    """
    if executor == "serial":
        return ((job, execute(job)) for job in jobs)
    if executor == "dask":
        return on_cluster(jobs, scheduler or os.environ.get(ADDRESS), processes or available_cores(), timeout)
    if executor == "local":
        if getattr(multiprocessing.current_process(), "_inheriting", False):
            raise InputError(_UNGUARDED)
        return _local(jobs, min(processes or available_cores(), max(len(jobs), 1)), timeout)
    raise InputError(f"unknown executor '{executor}'; known: {', '.join(EXECUTORS)}")


def available_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Queue:
    """Jobs by group. A worker stays with its group, then takes one that nobody has, then helps with the longest."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._numbers: dict[Group, list[Iterator[int]]] = {}
        self._left: dict[Group, int] = {}
        self._again: dict[Group, list[Job]] = {}
        self._taken: dict[int, Group] = {}
        for group, numbers in jobs.groups():
            self._numbers.setdefault(group, []).append(iter(numbers))
            self._left[group] = self._left.get(group, 0) + len(numbers)

    @property
    def left(self) -> int:
        """How many jobs no worker has yet."""
        return sum(self._left.values())

    def next(self, worker: int) -> Job | None:
        """Return the next job for a worker, or ``None`` when there is none left."""
        group = self._taken.get(worker)
        if group is None or not self._left.get(group):
            self._left = {key: count for key, count in self._left.items() if count}
            free = [key for key in self._left if key not in self._taken.values()]
            group = next(iter(free), None) or max(self._left, key=lambda key: self._left[key], default=None)
            if group is None:
                return None
            self._taken[worker] = group
        self._left[group] -= 1
        number = next(chain.from_iterable(self._numbers[group]), None)
        return self._again[group].pop() if number is None else self._jobs[number]

    def give_back(self, job: Job) -> None:
        """Take a job back, to be done once more."""
        self._again.setdefault(job.group, []).append(job)
        self._left[job.group] = self._left.get(job.group, 0) + 1


def _local(jobs: Jobs, processes: int, timeout: float) -> Results:
    """One pool of one process for each worker, so that it is known which worker has compiled what."""
    from pebble import ProcessExpired, ProcessPool

    context = multiprocessing.get_context("spawn")
    queue = _Queue(jobs)
    ready: dict[str, Any] = {"initializer": _ready, "initargs": [os.getpid()]}
    pools: list[Any] = [ProcessPool(max_workers=1, context=context, **ready) for _ in range(processes)]
    running: dict[Future[Any], tuple[int, Job]] = {}
    given = [0] * processes
    again: set[str] = set()

    def start(worker: int) -> None:
        """Give a worker its next job; another one to wait behind it, so that it need not, while there are many."""
        while given[worker] < (2 if queue.left > 2 * processes else 1):
            job = queue.next(worker)
            if job is None:
                return
            try:
                running[pools[worker].schedule(execute, args=[job], timeout=timeout)] = (worker, job)
            except RuntimeError:  # the pool is broken: its process could not even start
                raise InputError(_UNGUARDED) from None
            given[worker] += 1

    try:
        for worker in range(processes):
            start(worker)
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                worker, job = running.pop(future)
                given[worker] -= 1
                if isinstance(future.exception(), ProcessExpired) and job.key not in again:
                    again.add(job.key)  # whatever killed it may have come from outside
                    queue.give_back(job)
                    start(worker)
                    continue
                start(worker)
                yield job, _outcome(job, future.result, timeout)
    finally:
        for pool in pools:
            pool.stop()
        for pool in pools:
            pool.join()


def _ready(parent: int) -> None:
    """Keep a worker to one core, leave Ctrl-C to its parent, and import what fits need before any clock runs."""
    import importlib
    import signal

    import fricmodels.score  # noqa: F401
    from fricmodels.processes import end_with_parent

    end_with_parent(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    for module in ("casadi", "numba", "scipy.optimize"):
        importlib.import_module(module)
    plugins.load()


def _outcome(job: Job, result: Callable[[], Row], timeout: float) -> Row:
    from pebble import ProcessExpired

    try:
        return result()
    except TimeoutError:
        return job.row(Status.TIMEOUT, f"took longer than {timeout:g} s", timeout)
    except ProcessExpired as error:
        return job.row(Status.CRASHED, f"its process died with exit code {error.exitcode}")
    except Exception as error:
        return job.row(Status.CRASHED, f"{type(error).__name__}: {error}")
