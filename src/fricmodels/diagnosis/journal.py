"""What a ladder has found so far, kept as it comes: one that is interrupted goes on from there, to the same end.

A ladder is a fixed sequence of long steps, searches for effects and fits, with quick ones between them. What a long
step found is a few numbers. They are written down, a line each, and where the same ladder is begun again they are taken
in the place of the work, in the same order; everything else is computed anew from them, bit for bit.
"""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any, TextIO, TypeVar

import numpy as np

from fricmodels import plugins
from fricmodels.diagnosis import repeated
from fricmodels.drive import Drive
from fricmodels.files import locked
from fricmodels.recording import Recording
from fricmodels.term import Effect
from fricmodels.weakform.candidate import NonlinearOptimum
from fricmodels.weakform.estimate import Estimate, estimate, rows_again
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.search import search

FILE = ".improve.jsonl"
_SCHEMA = "fricmodels/improve-journal/3"
_open: ContextVar[Journal | None] = ContextVar("journal", default=None)

Found = TypeVar("Found")


class Journal:
    """The long steps of one ladder, in order.

    Args:
        path: its file; made where there is none, begun anew where it is of another ladder.
        of: what decides the ladder, as :func:`identity` gives it.
    """

    def __init__(self, path: Path, of: str) -> None:
        self._path, self._next = path, 0
        self._file: TextIO | None = None
        self._known: list[dict[str, Any]] = []
        with suppress(OSError):  # without a journal the ladder is the same
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(path, "a+", encoding="utf-8")  # noqa: SIM115
            if locked(self._file.fileno()) is False:  # another one writes it
                self.close()
                return
            self._known = self._read(of)
            if not self._known:
                self._file.truncate(0)
                self._write({"schema": _SCHEMA, "of": of})
            self._known = self._known[1:]

    def __len__(self) -> int:
        return len(self._known)

    def step(
        self, name: str, compute: Callable[[], Found], plain: Callable[[Found], Any], back: Callable[[Any], Found]
    ) -> Found:
        """Return what a step finds: as it stands here, or as it is computed, and then it stands here.

        Args:
            name: what the step is. One of another name, and all after it, are forgotten.
            compute: does it. plain: its result as plain values. back: the result from them.
        """
        number, self._next = self._next, self._next + 1
        if number < len(self._known) and self._known[number].get("step") == name:
            return back(self._known[number]["found"])
        found = compute()
        if number < len(self._known):  # it was another ladder after all
            self._known = []
            self.remove()
        kept = plain(found)
        self._write({"step": name, "found": kept, "check": _check(name, kept)})
        return found

    def remove(self) -> None:
        """Remove the file: the ladder has come to its end."""
        if self._file is not None:
            with suppress(OSError):
                self._path.unlink()
            self.close()

    def _read(self, of: str) -> list[dict[str, Any]]:
        """Return the lines as they were written, the heading first; none where they are of another ladder.

        What follows the first half line, or one that was changed, is cut off.
        """
        assert self._file is not None
        self._file.seek(0)
        kept: list[dict[str, Any]] = []
        size = 0
        for text in self._file.buffer.read().splitlines(keepends=True):
            line = _line(text)
            if line is None or (not kept and line != {"schema": _SCHEMA, "of": of}):
                break
            if kept and line.get("check") != _check(line.get("step"), line.get("found")):
                break
            kept.append(line)
            size += len(text)
        os.truncate(self._path, size)
        return kept

    def _write(self, content: Mapping[str, Any]) -> None:
        if self._file is None:
            return
        try:
            self._file.write(json.dumps(content) + "\n")
            self._file.flush()
        except OSError:  # the disk is full: what is kept would have no end
            self.remove()

    def close(self) -> None:
        """Let go of the file; what stands in it stays."""
        file, self._file = self._file, None
        if file is not None:
            with suppress(OSError):
                file.close()


@contextmanager
def journal(path: Path, of: str) -> Iterator[Journal]:
    """Keep a journal of the ladder within; it is removed at its end, whatever that is but an interruption."""
    kept = Journal(path, of)
    token = _open.set(kept)
    try:
        yield kept
    except Exception:
        kept.remove()
        raise
    else:
        kept.remove()
    finally:
        _open.reset(token)
        kept.close()


def identity(recording: Recording, *decides: object) -> str:
    """Return a hash of what decides a ladder: the recording, what was asked, and the code that does it."""
    from fricmodels.tournament.code import digest

    content = hashlib.sha256(f"{recording.checksum} {decides!r}".encode())
    registries = plugins.load().registries.values()
    names = {registry.entry(name).distribution for registry in registries for name in registry}
    for name in sorted(names | {"fricmodels"}):
        content.update(digest(name).encode())
    for file in sorted(Path(__file__).parent.glob("*.py")):
        content.update(file.read_bytes())
    return content.hexdigest()


def searched(
    problem: WeakFormProblem, regression: Regression, effect: Effect, alone: Drive, rival: float
) -> NonlinearOptimum | None:
    """Return :func:`fricmodels.weakform.search.search`, or what it found before."""

    def anew() -> NonlinearOptimum | None:
        return search(problem, regression, effect, alone, rival)

    def compute() -> NonlinearOptimum | None:
        return repeated.once(problem, regression, effect, alone, rival, anew)

    def plain(found: NonlinearOptimum | None) -> Any:
        if found is None:
            return None
        point, *others = repeated.plain(found)
        return [[*point], *others]

    def back(known: Any) -> NonlinearOptimum | None:
        return None if known is None else repeated.again(problem, regression, effect, alone, known)

    kept = _open.get()
    return compute() if kept is None else kept.step(f"{problem.drive.model.name} + {effect.name}", compute, plain, back)


def estimated(
    drive: Drive, recording: Recording, start: Mapping[str, float] | None = None
) -> tuple[WeakFormProblem, Estimate]:
    """Return :func:`fricmodels.weakform.estimate.estimate`, or what it found before, with the rows made anew."""

    def plain(found: tuple[WeakFormProblem, Estimate]) -> Any:
        rows, fit = found
        covariance = None if fit.covariance is None else fit.covariance.tolist()
        return {
            "rows": _floats(rows.made_for),
            "parameters": _floats(fit.parameters),
            "standard_errors": _floats(fit.standard_errors),
            "covariance": covariance,
            "not_identified": dict(fit.not_identified),
            "told_by_kept_back": list(fit.told_by_kept_back),
            "shift": float(fit.shift),
            "known_shift": float(rows.shift),
            "residual_percent": float(fit.residual_percent),
            "message": fit.message,
        }

    def back(known: Any) -> tuple[WeakFormProblem, Estimate]:
        fit = {key: value for key, value in known.items() if key not in ("rows", "known_shift")}
        covariance = None if fit["covariance"] is None else np.array(fit["covariance"], dtype=float)
        told = tuple(fit["told_by_kept_back"])
        found = Estimate(**{**fit, "covariance": covariance, "told_by_kept_back": told})
        return rows_again(drive, recording, known["rows"], found, known["known_shift"]), found

    kept = _open.get()
    if kept is None:
        return estimate(drive, recording, start)
    return kept.step(f"fit {drive.model.name}", lambda: estimate(drive, recording, start), plain, back)


def _line(text: bytes) -> dict[str, Any] | None:
    """Return what stands in a line; ``None`` for one that is not whole."""
    try:
        line = json.loads(text) if text.endswith(b"\n") else None
    except (ValueError, RecursionError):
        return None
    return line if isinstance(line, dict) else None


def _check(name: Any, found: Any) -> int:
    """Return a checksum of a step."""
    return zlib.crc32(json.dumps([name, found]).encode())


def _floats(values: Mapping[str, float]) -> dict[str, float]:
    return {key: float(value) for key, value in values.items()}
