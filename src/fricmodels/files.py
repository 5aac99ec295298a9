"""Writes files whole or not at all."""

from __future__ import annotations

import json
import os
import re
import tempfile
from array import array
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from fricmodels.errors import InputError

_SUFFIX = ".fricmodels.part"
_OURS = re.compile(r"\..+\.[a-z0-9_]{8}\.fricmodels\.part")
_tidied: set[Path] = set()


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Yield a path beside the file to write to, and put it in the file's place once all is written.

    The directory is made. What was there stays where writing fails.

    Raises:
        InputError: when the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_left_over(path.parent)
        handle, beside = _begun(path)
        try:
            yield beside
            beside.chmod(0o644)
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)
            os.close(handle)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from None


def remove_left_over(folder: Path) -> None:
    """Remove what a program that was killed left of files it was writing; once for each folder.

    Only files with the name that :func:`replaced` gives, and no file that a living process holds: that one has a lock
    on it, which ends with the process whatever ends that. Where the system has no such locks nothing is removed.
    """
    place = folder.absolute()
    if place in _tidied:
        return
    _tidied.add(place)
    with suppress(OSError):
        for left in [Path(entry.path) for entry in os.scandir(folder) if _OURS.fullmatch(entry.name)]:
            with suppress(OSError):
                handle = os.open(left, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
                try:
                    if locked(handle):
                        left.unlink(missing_ok=True)
                finally:
                    os.close(handle)


def _begun(path: Path) -> tuple[int, Path]:
    """Return a new file beside another one, and its handle, which is locked as long as it is open."""
    while True:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=_SUFFIX)
        try:
            if locked(handle) is not False and os.stat(name).st_ino == os.fstat(handle).st_ino:
                return handle, Path(name)
        except FileNotFoundError:  # another process took it for left over before it was locked
            pass
        os.close(handle)


def locked(handle: int) -> bool | None:
    """Lock a file for this process; whether that could be done, ``None`` where the system has no such locks."""
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return None
    return True


def write_text(path: Path, text: str) -> Path:
    """Write a text in UTF-8; see :func:`replaced`."""
    return write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, content: bytes) -> Path:
    """Write bytes; see :func:`replaced`."""
    with replaced(path) as beside:
        beside.write_bytes(content)
    return path


def write_listed(path: Path, content: Mapping[str, Any], name: str, items: Iterable[Any]) -> array[int]:
    """Write a JSON document that ends with a list, a line each key; no two items are held at a time: :func:`replaced`.

    Args:
        path: the file.
        content: what stands before the list.
        name: key of the list.
        items: what is in it.

    Returns:
        Where each item begins in the file, and how many bytes it has: two whole numbers each, one item after the other.

    Raises:
        ValueError: for a number that JSON does not have.
    """
    encoder = json.JSONEncoder(indent=1, allow_nan=False, ensure_ascii=False)
    places = array("q")
    with replaced(path) as beside, beside.open("wb") as stream:
        stream.write(encoder.encode({**content, name: []}).removesuffix("]\n}").encode())
        for item in items:
            stream.write(b",\n  " if places else b"\n  ")
            text = encoder.encode(item).replace("\n", "\n  ").encode()
            places.extend((stream.tell(), len(text)))
            stream.write(text)
        stream.write(b"\n ]\n}\n" if places else b"]\n}\n")
    return places


def check_table_name(path: Path) -> None:
    """Refuse a file of a table whose name says no format.

    Raises:
        InputError: for another suffix than .csv or .parquet.
    """
    if path.suffix not in (".csv", ".parquet"):
        raise InputError(f"cannot write '{path}': the name must end in .csv or .parquet")
