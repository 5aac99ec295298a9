"""A process that does jobs one after the other within a limit of time: for workers that cannot be ended themselves.

A worker of Dask does its jobs in threads, and nothing ends a thread that spins in compiled code. So each thread has a
process of its own, which keeps what it has compiled from job to job, and is killed where a job takes too long. Jobs and
rows go through its pipes as lines of JSON.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import asdict
from typing import Any, NoReturn

from fricmodels.errors import FricmodelsError
from fricmodels.fit import Status
from fricmodels.processes import end_with_parent
from fricmodels.tournament.jobs import Job, Row, execute
from fricmodels.tournament.sources import Source

_STARTS = 120.0
"""Seconds in which the process must have imported what fits need."""
_CODE = "import sys; from fricmodels.tournament.served import serve; serve(int(sys.argv[1]))"
_own = threading.local()


class Died(FricmodelsError):
    """The process of a job ended by itself."""


class Server:
    """A process that does jobs, until it is ended."""

    def __init__(self) -> None:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        self._process = subprocess.Popen(
            [sys.executable, "-c", _CODE, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
        )
        self._line(_STARTS)  # it says when it is ready: imports are not of a job's time

    def do(self, job: Job, seconds: float) -> Row:
        """Do one job.

        Raises:
            TimeoutError: where it takes longer; the process is ended then.
            Died: where the process ended.
        """
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(asdict(job)).encode() + b"\n")
            self._process.stdin.flush()
        except OSError:
            self._ended()
        row: Row = json.loads(self._line(seconds))
        return row

    def _line(self, seconds: float) -> bytes:
        late = threading.Event()

        def stop() -> None:
            late.set()
            self._process.kill()

        timer = threading.Timer(seconds, stop)
        timer.start()
        try:
            assert self._process.stdout is not None
            line = self._process.stdout.readline()
        finally:
            timer.cancel()
        if not line.endswith(b"\n"):
            if late.is_set():
                self._let_go()
                raise TimeoutError
            self._ended()
        return line

    def _ended(self) -> NoReturn:
        raise Died(f"its process died with exit code {self._let_go()}")

    def _let_go(self) -> int:
        for stream in (self._process.stdin, self._process.stdout):
            with suppress(OSError):  # what it did not take any more
                assert stream is not None
                stream.close()
        return self._process.wait()


def within(job: Job, seconds: float) -> Row:
    """Do a job in this thread's own process; return its row, also where it took too long or its process died."""
    for trial in range(2):
        server = getattr(_own, "server", None)
        try:
            if server is None:
                server = _own.server = Server()
            row: Row = server.do(job, seconds)
            return row
        except TimeoutError:
            _own.server = None
            return job.row(Status.TIMEOUT, f"took longer than {seconds:g} s", seconds)
        except Died as error:
            _own.server = None
            if trial:  # whatever killed it the first time may have come from outside
                return job.row(Status.CRASHED, str(error))
    raise AssertionError("a second trial returns")


def serve(parent: int) -> None:
    """Do the jobs that come on standard input, and write a row for each on standard output, until there are no more."""
    end_with_parent(parent)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a plugin prints is no row

    def say(content: Any) -> None:
        answers.write(json.dumps(content).encode() + b"\n")
        answers.flush()

    import fricmodels.score  # noqa: F401
    from fricmodels import plugins

    plugins.load()
    say("ready")
    for line in sys.stdin.buffer:
        given = json.loads(line)
        say(execute(Job(**{**given, "source": Source(**given["source"])})))
