"""Rows of a leaderboard that stay in its file: each is read when it is asked for."""

from __future__ import annotations

import json
import os
import threading
import weakref
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any, overload

from fricmodels.tournament.jobs import Row


class WrittenRows(Sequence[Row]):
    """The rows that were just written to a file, as they were written, whatever becomes of the file's name.

    Args:
        path: the file.
        places: where each row begins in it, and how many bytes it has, as
            :func:`fricmodels.files.write_listed` gives them.
    """

    def __init__(self, path: Path, places: array[int]) -> None:
        self._places = places
        self._file = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        self._turn = threading.Lock()
        weakref.finalize(self, os.close, self._file)

    def __len__(self) -> int:
        return len(self._places) // 2

    @overload
    def __getitem__(self, number: int) -> Row: ...

    @overload
    def __getitem__(self, number: slice) -> tuple[Row, ...]: ...

    def __getitem__(self, number: int | slice) -> Row | tuple[Row, ...]:
        if isinstance(number, slice):
            return tuple(self[each] for each in range(*number.indices(len(self))))
        if not -len(self) <= number < len(self):
            raise IndexError(f"there are {len(self)} rows, none with the number {number}")
        begin, count = self._places[2 * (number % len(self)) : 2 * (number % len(self)) + 2]
        with self._turn:
            os.lseek(self._file, begin, os.SEEK_SET)
            content = os.read(self._file, count)
        row: Row = json.loads(content)
        return row

    def __eq__(self, other: Any) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return len(self) == len(other) and all(mine == its for mine, its in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]
