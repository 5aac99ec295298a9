"""Comma-separated values, also with ; | tabs or blanks; decimal points or commas; comments; a row of units."""

from __future__ import annotations

import io
import mmap
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader
from fricmodels.readers.dialect import DECIMAL_COMMA, Dialect, fields_of, lines_of, sniff
from fricmodels.readers.labelled import without_labels

if TYPE_CHECKING:
    import pandas as pd

_INTERRUPTED = "Calling read(nbytes) on source failed"
"""What pandas makes of an exception without a text while it reads, which is an interrupt; all others keep theirs."""


class CsvReader(Reader):
    """Delimited text, mostly with a header row.

    Delimiter and decimal mark are found from the file. Lines that begin with ``#`` or ``%`` are comments, also before
    the header; where there is no other header, a comment right above the data is it. A row of units below the header
    (no number in it) gives the units of columns mapped without one. Lines may also name each of their numbers, as in
    ``Time: 5001 Position: 595``. Where nothing names the columns they are called by their number, 1 for the first.
    """

    name = "csv"
    suffixes = (".csv", ".tsv", ".txt", ".dat")
    summary = "delimited text: , ; | tab or blanks, decimal points or commas"

    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns; numbers where a whole column is numbers."""
        import pandas as pd

        dialect = sniff(path)
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            try:
                frame = _frame(path, dialect)
            except (pd.errors.ParserError, pd.errors.ParserWarning) as error:
                if _INTERRUPTED in str(error):
                    raise KeyboardInterrupt from None
                raise InputError(f"{path}: {_ragged(path, dialect, error)}") from None
            except pd.errors.EmptyDataError:
                raise InputError(f"{path}: there is a header but no data below it") from None
            except UnicodeError as error:
                raise InputError(f"{path}: {_no_text(path, dialect, error)}") from None
        if dialect.decimal == ",":
            for column in frame.select_dtypes(exclude="number"):  # with what is no number in it all of it is text
                frame[column] = frame[column].replace(DECIMAL_COMMA, r"\1.\2", regex=True)
        frame.columns = pd.Index(dialect.header)
        frame.attrs["units"] = dialect.units
        return frame

    def place(self, path: Path, row: int) -> str:
        """Return the line, counted from 1 with comments and blank lines."""
        dialect = sniff(path)
        for count, (number, _) in enumerate(lines_of(path, dialect.encoding, dialect.first)):
            if count == row:
                return f"line {number}"
        return f"row {row + 1}"


def _frame(path: Path, dialect: Dialect) -> pd.DataFrame:
    import pandas as pd

    content: Path | io.StringIO = path
    if dialect.labelled:
        text = path.read_text(encoding=dialect.encoding)
        content = io.StringIO(without_labels(text, dialect.header))
    return pd.read_csv(
        content,
        sep=r"\s+" if dialect.delimiter == " " else dialect.delimiter,
        decimal=dialect.decimal,
        comment=_comment_within(path, dialect),
        header=None,
        names=list(range(len(dialect.header))),
        index_col=False,
        skiprows=dialect.first,
        encoding=dialect.encoding,
        skipinitialspace=True,
        low_memory=False,
    )


def _comment_within(path: Path, dialect: Dialect) -> str | None:
    """Return the mark of comment lines among the data, if there are any."""
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
        for _ in range(dialect.first):
            content.readline()
        found = re.compile(rb"\n[ \t]*([#%])").search(content, max(content.tell() - 1, 0))
        return found[1].decode() if found else None


def _ragged(path: Path, dialect: Dialect, error: Exception) -> str:
    for number, line in lines_of(path, dialect.encoding, dialect.first):
        count = len(fields_of(line, dialect.delimiter))
        if count > len(dialect.header):
            return f"line {number} has {count} fields where the header has {len(dialect.header)}; repair that line"
    return f"cannot be read as a table: {' '.join(str(error).split())}"


def _no_text(path: Path, dialect: Dialect, error: UnicodeError) -> str:
    """Say where a file that began as text is none."""
    for number, line in lines_of(path, dialect.encoding):
        if "\N{REPLACEMENT CHARACTER}" in line:
            encoding = dialect.encoding.removesuffix("-sig").upper()
            return f"line {number} is no {encoding}; repair that line, or save the file anew"
    return f"cannot be read as text: {error}"
