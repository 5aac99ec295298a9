"""Does jobs on a Dask cluster: workers that share no disk get the recordings, those without a plugin are named.

Each job has the limit of time that it has elsewhere. A worker that dies is no matter: the scheduler gives its jobs, and
results that nobody has taken yet, to another one. A job whose result or recording died with all workers that had it is
given to the cluster once more.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from fricmodels.errors import InputError
from fricmodels.files import write_bytes
from fricmodels.fit import Status
from fricmodels.tournament.code import digest, distributions
from fricmodels.tournament.jobs import Job, Row
from fricmodels.tournament.listed import Jobs
from fricmodels.tournament.served import within
from fricmodels.tournament.sources import Source

ADDRESS = "DASK_SCHEDULER_ADDRESS"
"""Environment variable: the scheduler of a running cluster, where no other is named."""
_ANSWERS = "15s"
_AHEAD = 64
"""Jobs for each core that the cluster is given at a time: none waits, and memory does not grow with how many there are.
"""
_TRIES = 3
"""How often a job is given to the cluster: recordings die with the only worker that was there when they were sent."""

Results = Iterator[tuple[Job, Row]]


def on_cluster(jobs: Jobs, address: str | None, workers: int, timeout: float) -> Results:
    """Do jobs on a running cluster, or on one that is started here, and yield each with its row as they finish.

    Args:
        jobs: what is to be done.
        address: of the scheduler; without it a cluster of processes is started on this machine alone.
        workers: how many processes that one has.
        timeout: seconds for one job.

    Raises:
        InputError: where Dask is not installed, no scheduler answers, or a worker has other code than is here.
    """
    try:
        dask: Any = importlib.import_module("distributed")
    except ImportError:
        raise InputError("the executor 'dask' needs the extra: pip install 'fricmodels[dask]'") from None
    if address:
        try:
            with dask.Client(address, timeout=_ANSWERS) as client, client.as_current():
                yield from _done(client, jobs, timeout)
        except (OSError, TimeoutError, ValueError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise InputError(f"the Dask scheduler at {address} cannot be used: {reason[:200]}") from None
        return
    here = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None, "host": "127.0.0.1"}
    with dask.LocalCluster(**here) as cluster, dask.Client(cluster) as client, client.as_current():
        yield from _done(client, jobs, timeout)


def _done(client: Any, jobs: Jobs, timeout: float) -> Results:
    if not jobs:
        return
    simulated = {model for source in jobs.sources for model in source.models}
    names = frozenset().union(*(distributions(group[1], group[0], *simulated) for group, _ in jobs.groups()))
    codes = {name: digest(name) for name in sorted(names)}
    _check_workers(client, codes)
    sent = _sent(client, jobs)
    waiting = iter(jobs)
    running: dict[Any, tuple[Job, int]] = {}
    ahead = _AHEAD * max(sum(client.ncores().values()), 1)

    def submit(job: Job, attempt: int = 1) -> Any:
        files = {path: sent[path] for path in files_of(job.source) if path in sent}
        key = f"fricmodels-{job.key}-{attempt}"
        future = client.submit(far, job, codes, files, timeout, pure=False, key=key)
        running[future.key] = job, attempt
        return future

    first = [submit(job) for job in islice(waiting, ahead)]
    finished: Any = importlib.import_module("distributed").as_completed(first)
    for future in finished:
        job, attempt = running.pop(future.key)
        row = _outcome(job, future.result, last=attempt == _TRIES)
        future.release()
        if row is None:
            if any(content.status != "finished" for content in sent.values()):  # once for all jobs that lost them
                sent = _sent(client, jobs)
            finished.add(submit(job, attempt + 1))
            continue
        for following in islice(waiting, 1):
            finished.add(submit(following))
        yield job, row


def _outcome(job: Job, result: Callable[[], Row], last: bool) -> Row | None:
    """Return a job's row; nothing where its result or recording is lost and it may be given once more."""
    try:
        return result()
    except Exception as error:
        if isinstance(error, CancelledError) and not last:
            return None
        return job.row(Status.CRASHED, f"on the cluster: {type(error).__name__}: {error}")


def files_of(source: Source) -> list[str]:
    """Return the files that a recording is read from."""
    values = source.values
    return [*values.get("files", ()), *values.get("test_files", ()), *([values["file"]] if "file" in values else ())]


def _check_workers(client: Any, codes: Mapping[str, str]) -> None:
    """Refuse workers that lack a distribution, or have another version of it."""
    client.wait_for_workers(1, timeout=_ANSWERS)
    for worker, found in client.run(known, [*codes], on_error="return").items():
        if isinstance(found, BaseException):
            raise InputError(
                f"worker {worker} cannot be used: {type(found).__name__}: {found}; install fricmodels there"
            )
        for name, code in codes.items():
            if found[name] == code:
                continue
            what = "does not have" if found[name] == "" else "has another version of"
            raise InputError(f"worker {worker} {what} {name}; install there what is here: fricmodels plugins lists it")


def known(names: list[str]) -> dict[str, str]:
    """Return the hash of the code of each distribution where this runs; empty for one that is not there."""
    from fricmodels import plugins

    registries = plugins.load().registries.values()
    there = {registry.entry(name).distribution for registry in registries for name in registry}
    return {name: digest(name) if name in there else "" for name in names}


def _sent(client: Any, jobs: Jobs) -> dict[str, Any]:
    """Send the files that some worker does not have as they are here; return what stands for each, by path.

    Every worker gets them: what only one holds is lost with it.
    """
    client.wait_for_workers(1, timeout=_ANSWERS)
    paths = sorted({path for source in jobs.sources for path in files_of(source)})
    sums = {path: checksum(path) for path in paths if Path(path).is_file()}
    lacking: set[str] = set()
    for lacks in client.run(lacked, sums).values():
        lacking |= set(lacks)
    return {path: client.scatter(Path(path).read_bytes(), hash=False, broadcast=True) for path in sorted(lacking)}


def checksum(path: str) -> str:
    """Return the hash of a file's content; empty where it cannot be read."""
    try:
        with Path(path).open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""


def lacked(sums: Mapping[str, str]) -> list[str]:
    """Return the files that are not here with the same content."""
    return [path for path, content in sums.items() if checksum(path) != content]


def far(job: Job, codes: Mapping[str, str], files: Mapping[str, bytes], timeout: float) -> Row:
    """Do a job on a worker, with the files that came along in the place of those that it does not have.

    Raises:
        InputError: where the worker has other code: one that joined after the others were looked at.
    """
    found = known([*codes])
    wrong = next((name for name, code in codes.items() if found[name] != code), None)
    if wrong is not None:
        raise InputError(f"this worker does not have {wrong} as it is where the tournament runs; install it there")
    source = replace(job.source, description=_placed(job.source.description, files)) if files else job.source
    return within(replace(job, source=source), timeout)


def _placed(description: str, files: Mapping[str, bytes]) -> str:
    """Return a description whose files are where this worker keeps those that came along."""
    places = {path: _kept(path, content) for path, content in files.items()}
    values = json.loads(description)
    for key in ("files", "test_files"):
        if key in values:
            values[key] = [places.get(path, path) for path in values[key]]
    if "file" in values:
        values["file"] = places.get(values["file"], values["file"])
    return json.dumps(values, sort_keys=True)


def _kept(path: str, content: bytes) -> str:
    """Write a file that came along, once, under its own name; return its place."""
    folder = Path(tempfile.gettempdir()) / "fricmodels-recordings" / hashlib.sha256(content).hexdigest()[:32]
    place = folder / Path(path).name
    with suppress(OSError):
        if place.stat().st_size == len(content):
            return str(place)
    return str(write_bytes(place, content))
