"""Comma-separated values, and semicolons, tabs or blanks; decimal points or commas; comments; a row of units."""

from __future__ import annotations

import csv
import io
import mmap
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader
from fricmodels.readers.labelled import labels_of, without_labels

if TYPE_CHECKING:
    import pandas as pd

_COMMENTS = ("#", "%")
_NUMBER = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*$|\s*[-+]?(nan|inf(inity)?)\s*$", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d*,\d+([eE][-+]?\d+)?\s*$")


_LONGEST_LINE = 1_000_000
_MOST_COLUMNS = 10_000


@dataclass(frozen=True)
class Dialect:
    """How a text file is written: with a name before every number of a line if it is ``labelled``."""

    encoding: str
    delimiter: str
    decimal: str
    header: list[str]
    units: dict[str, str]
    first: int
    """Number of lines before the first line of data."""
    labelled: bool = False


class CsvReader(Reader):
    """Delimited text, mostly with a header row.

    Delimiter and decimal mark are found from the file. Lines that begin with ``#`` or ``%`` are comments, also before
    the header; where there is no other header, a comment right above the data is it. A row of units below the header
    (no number in it) gives the units of columns mapped without one. Lines may also name each of their numbers, as in
    ``Time: 5001 Position: 595``. Where nothing names the columns they are called by their number, 1 for the first.
    """

    name = "csv"
    suffixes = (".csv", ".tsv", ".txt", ".dat")
    summary = "delimited text: , ; tab or blanks, decimal points or commas"

    def table(self, path: Path) -> pd.DataFrame:
        """Return the columns; numbers where a whole column is numbers."""
        import pandas as pd

        dialect = sniff(path)
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            try:
                frame = _frame(path, dialect)
            except (pd.errors.ParserError, pd.errors.ParserWarning) as error:
                raise InputError(f"{path}: {_ragged(path, dialect, error)}") from None
            except pd.errors.EmptyDataError:
                raise InputError(f"{path}: there is a header but no data below it") from None
            except UnicodeError as error:
                raise InputError(f"{path}: {_no_text(path, dialect, error)}") from None
        frame.columns = pd.Index(dialect.header)
        frame.attrs["units"] = dialect.units
        return frame

    def place(self, path: Path, row: int) -> str:
        """Return the line, counted from 1 with comments and blank lines."""
        dialect = sniff(path)
        for count, (number, _) in enumerate(_lines(path, dialect.encoding, dialect.first)):
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


def _lines(path: Path, encoding: str, skip: int = 0) -> Iterator[tuple[int, str]]:
    """Yield (line number from 1, line) without comments and blank lines."""
    with path.open(encoding=encoding, errors="replace", newline=None) as stream:
        for number, line in enumerate(stream, start=1):
            if number > skip and line.strip() and not line.lstrip().startswith(_COMMENTS):
                yield number, line.rstrip("\r\n")


def _encoding(path: Path) -> str:
    with path.open("rb") as stream:
        start = stream.read(1 << 16)
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if b"\x00" in start:
        raise InputError(f"{path}: this is not text; name its format by the suffix or --reader")
    try:
        start[: len(start) - 4 if len(start) == 1 << 16 else None].decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _split(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    try:
        return [field.strip() for field in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]
    except csv.Error:  # a field of more than 131 072 characters
        return [field.strip() for field in line.split(delimiter)]


def sniff(path: Path) -> Dialect:
    """Find out how a text file is written, from its first lines.

    Raises:
        InputError: for a file with nothing in it, or with what is no table.
    """
    encoding = _encoding(path)
    lines = [pair for pair, _ in zip(_lines(path, encoding), range(50), strict=False)]
    longest = max(lines, key=lambda pair: len(pair[1]), default=(0, ""))
    if len(longest[1]) > _LONGEST_LINE:
        raise InputError(f"{path}: line {longest[0]} has {len(longest[1])} characters; is this a table of samples?")
    if not lines:
        raise InputError(f"{path}: the file is empty")
    if (labels := labels_of(lines[0][1])) is not None:
        return Dialect(encoding, ",", ".", labels, {}, lines[0][0] - 1, labelled=True)
    lines = _commented_header(path, encoding, lines[0][0], lines[0][1]) + lines
    number, header_line = lines[0]
    body = [line for _, line in lines[1:]]
    delimiter = _delimiter(header_line, body)
    header = _split(header_line, delimiter)
    named = not all(_is_number(field, delimiter) for field in header if field)
    if len(header) > _MOST_COLUMNS:
        raise InputError(
            f"{path}: line {number} names {len(header)} columns, more than {_MOST_COLUMNS}; keep those of one drive"
        )
    units: dict[str, str] = {}
    first = number
    if not named:
        header = [str(i) for i, _ in enumerate(header, start=1)]
        first, body = number - 1, [header_line, *body]
    elif body:
        fields = _split(body[0], delimiter)
        numeric = [bool(_NUMBER.match(field) or _DECIMAL_COMMA.match(field)) for field in fields]
        if len(body) > 1 and any(fields) and not any(numeric) and len(fields) <= len(header):
            units = {name: field.strip("[]() ") for name, field in zip(header, fields, strict=False)}
            units = {name: unit for name, unit in units.items() if unit not in ("", "-")}
            first, body = lines[1][0], body[1:]
    fields = [field for line in body for field in _split(line, delimiter)]
    commas = sum(bool(_DECIMAL_COMMA.match(field)) for field in fields)
    points = sum("." in field and bool(_NUMBER.match(field)) for field in fields)
    if body and len(_split(body[0], delimiter)) == len(header) + 1 and not _split(body[0], delimiter)[-1]:
        header = [*header, ""]
    return Dialect(encoding, delimiter, "," if commas > points else ".", header, units, first)


def _is_number(field: str, delimiter: str) -> bool:
    return bool(_NUMBER.match(field) or (delimiter != "," and _DECIMAL_COMMA.match(field)))


def _commented_header(path: Path, encoding: str, number: int, line: str) -> list[tuple[int, str]]:
    """Return the comment right above the data if it names the columns, where the first line is numbers already."""
    if number == 1 or not all(_NUMBER.match(field) for field in re.split(r"[\s,;]+", line.strip()) if field):
        return []
    with path.open(encoding=encoding, errors="replace") as stream:
        comment = [text for _, text in zip(range(number - 1), stream, strict=False)][-1].strip().lstrip("#% ")
    delimiter = _delimiter(comment, [line])
    names = len(_split(comment, delimiter))
    return [(number - 1, comment)] if names > 1 and names == len(_split(line, delimiter)) else []


def _delimiter(header: str, body: list[str]) -> str:
    for candidate in ("\t", ";", ","):
        if candidate in header:
            return candidate
    return " " if body and len(header.split()) == len(body[0].split()) > 1 else ","


def _comment_within(path: Path, dialect: Dialect) -> str | None:
    """Return the mark of comment lines among the data, if there are any."""
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
        for _ in range(dialect.first):
            content.readline()
        found = re.compile(rb"\n[ \t]*([#%])").search(content, max(content.tell() - 1, 0))
        return found[1].decode() if found else None


def _ragged(path: Path, dialect: Dialect, error: Exception) -> str:
    for number, line in _lines(path, dialect.encoding, dialect.first):
        count = len(_split(line, dialect.delimiter))
        if count > len(dialect.header):
            return f"line {number} has {count} fields where the header has {len(dialect.header)}; repair that line"
    return f"cannot be read as a table: {' '.join(str(error).split())}"


def _no_text(path: Path, dialect: Dialect, error: UnicodeError) -> str:
    """Say where a file that began as text is none."""
    for number, line in _lines(path, dialect.encoding):
        if "\N{REPLACEMENT CHARACTER}" in line:
            encoding = dialect.encoding.removesuffix("-sig").upper()
            return f"line {number} is no {encoding}; repair that line, or save the file anew"
    return f"cannot be read as text: {error}"
