"""Writes files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fricmodels.errors import InputError


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Yield a path beside the file to write to, and put it in the file's place once all is written.

    The directory is made. What was there stays where writing fails.

    Raises:
        InputError: when the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        os.close(handle)
        beside = Path(name)
        try:
            yield beside
            beside.chmod(0o644)
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from None


def write_text(path: Path, text: str) -> Path:
    """Write a text in UTF-8; see :func:`replaced`."""
    return write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, content: bytes) -> Path:
    """Write bytes; see :func:`replaced`."""
    with replaced(path) as beside:
        beside.write_bytes(content)
    return path
