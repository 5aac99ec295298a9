"""No command writes over what it reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path


def check_outputs(written: Iterable[Path | None], read: Iterable[Path | str | None]) -> None:
    """Refuse, before the work begins, an output that would take the place of a file that the command reads.

    Two names are one file where they lead to one, by links and relative paths too. Of a folder that is read, every
    file in it is.

    Args:
        written: files that will be written; ``None`` where an option was left out.
        read: files and folders that are read; ``None`` where an option was left out. A text counts where it ends in
            ``.json``: a model may be given by its name, or as a file.

    Raises:
        InputError: naming the file.
    """
    from fricmodels.errors import InputError

    inputs = [Path(each) for each in read if isinstance(each, Path) or (each is not None and each.endswith(".json"))]
    for out in written:
        if out is not None and any(_are_one(out, each) for each in _files(inputs)):
            raise InputError(f"{out}: is read by this command, and would be overwritten; name another file to write")


def _files(paths: Iterable[Path]) -> Iterator[Path]:
    for path in paths:
        yield from path.rglob("*") if path.is_dir() else (path,)


def _are_one(one: Path, other: Path) -> bool:
    try:
        return one.resolve() == other.resolve() or one.samefile(other)
    except (OSError, RuntimeError):  # one is not there yet, or a link leads round in a circle
        return False
