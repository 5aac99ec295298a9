"""Runs one command, and at each of its writes lets a copy of the process meet what may go wrong there.

At every file that is opened to be written, renamed, or folder that is made below a watched folder, the process forks
once for each fault. The copy meets the fault and goes on to its end; what it printed, its exit code and what lies in
the folder afterwards are kept. Then the folder is put back, and the process itself goes on as if nothing had been.
So a command's work is done once, however many of its writes are tried.

Run: ``python forked.py WATCHED SCRATCH COMMAND…``; prints what happened as JSON.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import resource
import shutil
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

WATCHED, SCRATCH = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
_LONGEST = 60
"""Seconds that a copy may take."""
happened: list[dict[str, Any]] = []
first = os.getpid()
active = False


def no_space() -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(WATCHED))


def read_only() -> None:
    raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(WATCHED))


def full_from_here_on() -> None:
    """Let the system refuse whatever any library writes to a file beyond its first bytes."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))


def killed() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


FAULTS: dict[str, Callable[[], None]] = {
    "no space": no_space,
    "read-only": read_only,
    "full from here on": full_from_here_on,
    "killed": killed,
}


def contents() -> dict[str, str]:
    return {
        str(path.relative_to(WATCHED)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(WATCHED.rglob("*"))
        if path.is_file()
    }


def written(event: str, arguments: tuple[Any, ...]) -> str | None:
    """Return what a system call would write, where that is below the watched folder."""
    path: Any = None
    if event == "open":
        path, mode, flags = arguments
        if isinstance(mode, str) and not set(mode) & set("wax+"):
            return None
        if not isinstance(mode, str) and not flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
            return None
    elif event == "os.rename":
        path = arguments[1]
    elif event in ("os.mkdir", "sqlite3.connect"):
        path = arguments[0]
    if not isinstance(path, str | os.PathLike):
        return None
    whole = Path(path).absolute()
    return str(whole.relative_to(WATCHED.parent)) if whole == WATCHED or WATCHED in whole.parents else None


def hook(event: str, arguments: tuple[Any, ...]) -> None:
    global active
    if not active:
        return
    path = written(event, arguments)
    if path is None:
        return
    active = False
    before = SCRATCH / "before"
    shutil.rmtree(before, ignore_errors=True)
    there = WATCHED.is_dir()
    if there:
        shutil.copytree(WATCHED, before, copy_function=os.link)
    for fault, meet in FAULTS.items():
        said = SCRATCH / "said"
        said.write_bytes(b"")
        pid = os.fork()
        if pid == 0:
            signal.alarm(_LONGEST)
            os.dup2(os.open(said, os.O_WRONLY | os.O_APPEND), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            meet()
            return
        status = os.waitpid(pid, 0)[1]
        found = {"event": event, "path": path, "fault": fault, "code": os.waitstatus_to_exitcode(status)}
        happened.append({**found, "said": said.read_text(errors="replace"), "files": contents()})
        shutil.rmtree(WATCHED, ignore_errors=True)
        if there:
            shutil.copytree(before, WATCHED, copy_function=os.link)
    active = True


def main() -> None:
    global active
    from fricmodels.cli import _run

    before = contents()
    sys.addaudithook(hook)
    active = True
    code = _run(sys.argv[3:])
    if os.getpid() != first:
        with suppress(Exception):
            sys.stderr.flush()
        os._exit(code)
    active = False
    Path(SCRATCH / "happened.json").write_text(
        json.dumps({"code": code, "before": before, "after": contents(), "happened": happened})
    )


main()
