"""Finds out, in a process of its own, whether a plugin lets the interpreter live.

Code that hangs or ends the process when it is imported cannot be caught by whoever imports it. So each entry point of
another distribution is first loaded by a child process with a time limit: import, hooks, one instance of each class,
and the equations of each law and effect, which every diagnosis builds. What the child does not survive is not imported
here. Both verdicts are kept in the cache directory, for as long as the plugin's files, its distribution and the
installed distributions beside it stay what they are: a start with nothing new costs a few look-ups. A cache that cannot
be read or written means that plugins are tried again, no more. The names that a plugin offered are kept beside its
verdict: once it breaks, they are known to be its own.
"""

from __future__ import annotations

import hashlib
import importlib.machinery
import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

from fricmodels.errors import InputError
from fricmodels.files import write_text
from fricmodels.processes import time_limit

LIMIT = "FRICMODELS_PLUGIN_TIMEOUT"
"""Environment variable: seconds that a plugin may take to be loaded the first time."""
_DEFAULT_LIMIT = 20.0
_UNDER_WAY = "FRICMODELS_PLUGIN_PROBE"
SURVIVED = 73
"""Exit code of a child that came to its end."""
_CODES = tuple(importlib.machinery.all_suffixes())
_CHILD = """\
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from fricmodels.plugins.child import run
run(*sys.argv[2:])
"""
_USE = 6.0
"""Seconds that building the equations of one class may take; they take milliseconds."""
_VERSION = "2"
"""Goes up when more is tried, so that earlier verdicts are made anew."""


def under_way() -> bool:
    """Whether this process is a child that tries a plugin; it loads no other."""
    return _UNDER_WAY in os.environ


@dataclass(frozen=True)
class Verdict:
    """What became of the process that tried a plugin.

    Attributes:
        reason: why it must not be imported; empty where it may be.
        dangers: kind, name and reason of each class that must not be used in a process that is to live.
    """

    reason: str = ""
    dangers: tuple[tuple[str, str, str], ...] = ()


def verdicts(points: Sequence[EntryPoint]) -> dict[tuple[str, str], Verdict]:
    """Return by distribution and name of the entry points what was found out about them.

    Raises:
        InputError: where the environment variable of the time limit is no positive number.
    """
    installed = [point for point in points if _is_installed(point)]
    if not installed or not sys.executable:
        return {}
    limit = time_limit(LIMIT, _DEFAULT_LIMIT, "a plugin may take to load")
    prints = {point: _fingerprint(point, limit) for point in installed}
    found = {point: _recalled(point, prints[point]) for point in installed}
    unknown = [point for point, verdict in found.items() if verdict is None]
    for point, verdict in _tried(unknown, limit):
        found[point] = verdict
        _remember(point, fingerprint=prints[point], reason=verdict.reason, dangers=verdict.dangers)
    return {(point.dist.name, point.name): verdict for point, verdict in found.items() if verdict and point.dist}


def _is_installed(point: EntryPoint) -> bool:
    """Whether an entry point has a distribution with files, of whichever class: `importlib_metadata` puts its own."""
    return hasattr(getattr(point, "dist", None), "locate_file")


def lost(point: EntryPoint, offers: Collection[tuple[str, str]], *, whole: bool) -> tuple[tuple[str, str], ...]:
    """Return kind and name of what a plugin offered when it was last whole and does not any more.

    Args:
        point: its entry point.
        offers: kind and name of what it offers now.
        whole: whether that is all that it has; then it is what is compared with from now on.
    """
    if not _is_installed(point):
        return ()
    listed = _read(point).get("offers")
    before = [tuple(pair) for pair in listed if _is_pair(pair)] if isinstance(listed, list) else []
    if whole:
        if before != list(offers):
            _remember(point, offers=list(offers))
        return ()
    return tuple((kind, name) for kind, name in before if (kind, name) not in offers)


def _is_pair(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(isinstance(part, str) for part in value)


def _fingerprint(point: EntryPoint, limit: float) -> str:
    """Return a hash that changes when the plugin, or what is installed beside it, does."""
    assert point.dist is not None
    beside = Path(str(point.dist.locate_file("")))
    parts = [
        _VERSION,
        point.name,
        point.value,
        point.dist.version,
        sys.version,
        str(limit),
        str(beside),
        *_installed_in(beside),
    ]
    parts += _stamps(_files(point.module.partition(".")[0]))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _installed_in(folder: Path) -> Iterator[str]:
    """Yield what changes when something is installed in a folder, or removed; kept bytecode is no such thing."""
    try:
        names = sorted(name for name in os.listdir(folder) if name != "__pycache__")
    except OSError:
        return
    yield from names
    yield from _stamps([folder / name for name in names if name.endswith((".dist-info", ".egg-info", ".pth"))])


def _files(package: str) -> Iterator[Path]:
    """Yield the files with code of a top-level package or module, found without importing it."""
    try:
        spec = importlib.util.find_spec(package)
    except (ImportError, AttributeError, ValueError):
        return
    if spec is None:
        return
    if spec.origin is not None:
        yield Path(spec.origin)
    for folder in spec.submodule_search_locations or ():
        for where, folders, names in os.walk(folder):
            folders[:] = sorted(name for name in folders if name != "__pycache__")
            yield from (Path(where, name) for name in sorted(names) if name.endswith(_CODES))


def _stamps(paths: Iterable[Path]) -> Iterator[str]:
    for path in paths:
        try:
            status = path.stat()
        except OSError:
            continue
        yield f"{path} {status.st_mtime_ns} {status.st_size}"


class _Trial:
    """A child that tries a plugin, and what it says that it does."""

    def __init__(self, process: subprocess.Popen[bytes], limit: float) -> None:
        assert process.stdout is not None
        self.process, self._limit = process, limit
        self.deadline = time.monotonic() + limit
        self._heard = b""
        os.set_blocking(process.stdout.fileno(), False)

    def listen(self) -> None:
        """Hear what it says; each use of a class has a limit of its own."""
        assert self.process.stdout is not None
        said = self.process.stdout.read(1 << 20)
        if said:
            self._heard += said
            self.deadline = time.monotonic() + min(self._limit, _USE)

    def close(self) -> None:
        """Let go of its output."""
        assert self.process.stdout is not None
        self.process.stdout.close()

    @property
    def using(self) -> tuple[str, str, str] | None:
        """Kind and name of the class that is used, and the method; ``None`` before."""
        lines = self._heard.splitlines()
        kind, name, method = json.loads(lines[-1]) if lines else ("", "", "")
        return (kind, name, method) if lines else None


def _tried(points: Sequence[EntryPoint], limit: float) -> Iterator[tuple[EntryPoint, Verdict]]:
    """Try each entry point in a child, as many at a time as there are processors; yield the verdict.

    A class whose use ends the child is noted, and the plugin is tried again without it.
    """
    waiting = deque(points)
    running: dict[EntryPoint, _Trial] = {}
    dangers: dict[EntryPoint, list[tuple[str, str, str]]] = {point: [] for point in points}
    try:
        while waiting or running:
            while waiting and len(running) < (os.cpu_count() or 1):
                point = waiting.popleft()
                skip = [(kind, name) for kind, name, _ in dangers[point]]
                try:
                    running[point] = _Trial(_launched(point, skip) if skip else _started(point), limit)
                except OSError:  # nothing can be started here; a tournament would fail to, and says so
                    continue
            for point, trial in list(running.items()):
                trial.listen()
                code = trial.process.poll()
                if code is None and time.monotonic() < trial.deadline:
                    continue
                del running[point]
                _end(trial.process)
                trial.listen()
                trial.close()
                if trial.using is None or code == SURVIVED:
                    yield point, Verdict(_reason(code, limit, "importing it"), tuple(dangers[point]))
                else:
                    kind, name, method = trial.using
                    dangers[point].append((kind, name, _reason(code, min(limit, _USE), f"its {method}")))
                    waiting.append(point)
            time.sleep(0.005)
    finally:
        for trial in running.values():
            _end(trial.process)
            trial.close()


def _started(point: EntryPoint) -> subprocess.Popen[bytes]:
    return _launched(point, [])


def _launched(point: EntryPoint, skip: list[tuple[str, str]]) -> subprocess.Popen[bytes]:
    given = [point.name, point.value, json.dumps(skip), str(os.getpid())]
    return subprocess.Popen(
        [sys.executable, "-c", _CHILD, json.dumps(sys.path), *given],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, _UNDER_WAY: "1"},
        start_new_session=True,
    )


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a child and all that it started."""
    try:
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    except (ProcessLookupError, PermissionError):
        pass
    process.wait()


def _reason(code: int | None, limit: float, doing: str) -> str:
    again = "it is tried again when its files change"
    if code is None:
        return f"{doing} does not end within {limit:g} s ({LIMIT} sets the limit); {again}"
    if code == SURVIVED:
        return ""
    if code < 0:
        name = signal.Signals(-code).name if -code in {*signal.Signals} else f"signal {-code}"
        return f"{doing} kills the interpreter ({name}); {again}"
    return f"{doing} ends the interpreter with exit code {code}; {again}"


def _verdict_file(point: EntryPoint) -> Path:
    """Return where the verdict on an entry point of this environment is kept."""
    from fricmodels.kernels.scan import cache_directory

    assert point.dist is not None
    what = f"{sys.executable}\n{point.dist.locate_file('')}\n{point.dist.name}\n{point.name}"
    return cache_directory() / f"plugin-{hashlib.sha256(what.encode()).hexdigest()[:24]}.json"


def _read(point: EntryPoint) -> dict[str, Any]:
    try:
        kept = json.loads(_verdict_file(point).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return kept if isinstance(kept, dict) else {}


def _recalled(point: EntryPoint, fingerprint: str) -> Verdict | None:
    """Return the verdict that was found for these very files, or ``None`` where they are new."""
    kept = _read(point)
    reason, dangers = kept.get("reason"), kept.get("dangers")
    if kept.get("fingerprint") != fingerprint or not isinstance(reason, str) or not isinstance(dangers, list):
        return None
    if not all(
        isinstance(one, list) and len(one) == 3 and all(isinstance(part, str) for part in one) for one in dangers
    ):
        return None
    return Verdict(reason, tuple((kind, name, why) for kind, name, why in dangers))


def _remember(point: EntryPoint, **news: Any) -> None:
    with suppress(OSError, InputError):
        write_text(_verdict_file(point), json.dumps({**_read(point), "plugin": point.name, **news}))
