"""What readers are: from a file to a table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

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

    @abstractmethod
    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns of the file as they stand there.

        Raises:
            InputError: when the file is not of this format, naming it and the place.
        """

    def place(self, path: Path, row: int) -> str:
        """Say where row ``row`` of the table, from 0, stands in the file: ``line 12``, or ``row 12`` from 1."""
        return f"row {row + 1}"
