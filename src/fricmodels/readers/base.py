"""What readers are: from a file to a table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    import pandas as pd


class Reader(ABC):
    """Reads one file format into a table; what its columns mean is decided elsewhere.

    A subclass names itself and the suffixes of its files, and writes :meth:`table`. Units that the file states go
    into ``table.attrs["units"]``, a mapping of column to unit. Columns of the same name are kept, all of them.
    """

    name: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]
    summary: ClassVar[str] = ""
    apart: ClassVar[bool] = False
    """Whether files are read by a process of their own: for a parser that a spoilt file may kill."""

    exam: ClassVar[Mapping[str, Any]] = {}
    """What the exam needs: ``{"write": FUNCTION}`` that writes a table as a file of this format."""

    @abstractmethod
    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns of the file as they stand there.

        Raises:
            InputError: when the file is not of this format, naming it and the place.
        """

    def table_for(self, path: Path, asked: Collection[str]) -> pd.DataFrame:
        """Return the table that has the columns asked for; a format that holds several tables chooses by them.

        Args:
            path: the file.
            asked: names that the mappings of the user may mean; most formats need none.
        """
        return self.table(path)

    def look(self, path: Path) -> None:  # noqa: B027
        """Look at the beginning of a file, in this process, so that what is of another format is refused at once.

        Raises:
            InputError: as :meth:`table`.
        """

    def place(self, path: Path, row: int) -> str:
        """Say where row ``row`` of the table, from 0, stands in the file: ``line 12``, or ``row 12`` from 1."""
        return f"row {row + 1}"

    def done(self) -> None:  # noqa: B027
        """Let go of what a table needed, once its columns were taken; most formats need nothing."""


class SeveralTables(Reader):
    """Reads a format that holds several tables: :meth:`table_for` chooses one, by what is asked for."""

    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns of the most common length."""
        return self.table_for(path, ())

    @abstractmethod
    def table_for(self, path: Path, asked: Collection[str]) -> pd.DataFrame:
        """Return the columns as long as those asked for."""
