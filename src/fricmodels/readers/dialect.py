"""How a text file with a table is written: delimiter, decimal mark, names of the columns, where the data begin."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fricmodels.errors import InputError
from fricmodels.readers import units
from fricmodels.readers.labelled import labels_of

_COMMENTS = ("#", "%")
_IN_BRACKETS = re.compile(r"[\[(][^\[\]()]+[\])]\s*$")
_NUMBER = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*$|\s*[-+]?(nan|inf(inity)?)\s*$", re.IGNORECASE)
_DIGITS, _BEHIND_A_COMMA = re.compile(r"\s*-?\d*([eE][-+]?\d+)?\s*$"), re.compile(r"\s*0\d+\s*$")
_DELIMITERS = ("\t", ";", ",", "|", " ")
DECIMAL_COMMA = re.compile(r"^(\s*[-+]?\d*),(\d+(?:[eE][-+]?\d+)?\s*)$")


_LONGEST_LINE = 1_000_000
_MOST_COLUMNS = 10_000
_LOOKED_AT = 200
"""Lines from which the dialect is told. A recorder may write dozens of its own settings before its table."""
_ROWS = 4
"""So many lines of numbers of one width are the beginning of a table."""

_PREAMBLE = 2
"""Lines before a table, names included, if there is more than names that the first line gives."""


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


def lines_of(path: Path, encoding: str, skip: int = 0) -> Iterator[tuple[int, str]]:
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


def fields_of(line: str, delimiter: str) -> list[str]:
    """Return the fields of a line, without blanks about them."""
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
    lines = [pair for pair, _ in zip(lines_of(path, encoding), range(_LOOKED_AT), strict=False)]
    longest = max(lines, key=lambda pair: len(pair[1]), default=(0, ""))
    if len(longest[1]) > _LONGEST_LINE:
        raise InputError(f"{path}: line {longest[0]} has {len(longest[1])} characters; is this a table of samples?")
    if not lines:
        raise InputError(f"{path}: the file is empty")
    if (labels := labels_of(lines[0][1])) is not None:
        return Dialect(encoding, ",", ".", labels, {}, lines[0][0] - 1, labelled=True)
    _refuse_commas_between_decimal_commas(path, lines)
    lines = _without_preamble(_commented_header(path, encoding, lines[0][0], lines[0][1]) + lines)
    number, header_line = lines[0]
    body = [line for _, line in lines[1:]]
    delimiter = _delimiter(header_line, body)
    header = fields_of(header_line, delimiter)
    delimiter = _of_rows(len(header), body, delimiter)
    named = not all(_is_number(field, delimiter) for field in header if field)
    if len(header) > _MOST_COLUMNS:
        raise InputError(
            f"{path}: line {number} names {len(header)} columns, more than {_MOST_COLUMNS}; keep those of one drive"
        )
    stated: dict[str, str] = {}
    first = number
    if not named:
        header = [str(i) for i, _ in enumerate(header, start=1)]
        first, body = number - 1, [header_line, *body]
    elif body:
        header = [name or str(i) for i, name in enumerate(header, start=1)] if header[0] == "" else header
        fields = fields_of(body[0], delimiter)
        numeric = [bool(_NUMBER.match(field) or DECIMAL_COMMA.match(field)) for field in fields]
        if len(body) > 1 and any(fields) and not any(numeric) and len(fields) <= len(header):
            pairs = [(name, field.strip("[]() ")) for name, field in zip(header, fields, strict=False)]
            stated = {name: unit for name, unit in pairs if unit not in ("", "-")}
            first, body = lines[1][0], body[1:]
    fields = [field for line in body for field in fields_of(line, delimiter)]
    commas = sum(bool(DECIMAL_COMMA.match(field)) for field in fields)
    points = sum("." in field and bool(_NUMBER.match(field)) for field in fields)
    if body and len(fields_of(body[0], delimiter)) == len(header) + 1 and not fields_of(body[0], delimiter)[-1]:
        header = [*header, ""]
    return Dialect(encoding, delimiter, "," if commas > points else ".", header, stated, first)


def _of_rows(width: int, body: list[str], delimiter: str) -> str:
    """Return what stands between the numbers: not what stands between the names, where that cuts no row into numbers.

    Another mark is taken where it cuts every row into numbers, as many as there are names.
    """

    def cut(line: str, mark: str) -> bool:
        fields = fields_of(line, mark)
        return len(fields) == width and _all_numbers(fields, mark)

    if width < 2 or not body or any(cut(line, delimiter) for line in body):
        return delimiter
    return next((mark for mark in _DELIMITERS if all(cut(line, mark) for line in body)), delimiter)


def _refuse_commas_between_decimal_commas(path: Path, lines: list[tuple[int, str]]) -> None:
    """Refuse a file whose commas stand both within its numbers and between them.

    Below a row of names all is digits and commas, more fields than names, and some fields begin with a zero though they
    are no number below one: they are what stands behind a decimal comma.

    Raises:
        InputError: naming the line and the way out.
    """
    names, rows = lines[0][1].split(","), [line.split(",") for _, line in lines[1:]]
    if len(names) < 2 or not rows or any(map(_NUMBER.match, names)):
        return
    behind = any(_BEHIND_A_COMMA.match(field) for row in rows for field in row)
    if behind and all(len(row) > len(names) and all(map(_DIGITS.match, row)) for row in rows):
        raise InputError(
            f"{path}: line {lines[1][0]} has {len(rows[0])} fields where the header names {len(names)} columns: commas "
            "stand within the numbers and between them; save it with semicolons between them, or with decimal points"
        )


def _without_preamble(lines: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Return the lines from the names of the columns on, where a recorder wrote lines of its own before them.

    That is where the first line has another number of fields than the table of numbers, or is no line of names though
    it is as wide: a title that a spreadsheet filled up with empty fields, or a group that stands above each of its
    columns. The names are in the last line before the table that is as wide, or in the one before that where the last
    has units; where none is as wide the table has no names.
    """
    own = _delimiter(lines[0][1], [lines[-1][1]])
    alike = len(fields_of(lines[0][1], own)) == len(fields_of(lines[-1][1], own)) > 1
    for delimiter in (own,) if alike else _DELIMITERS:
        rows = [fields_of(line, delimiter) for _, line in lines]
        widths = [len(row) if _all_numbers(row, delimiter) else 0 for row in rows]
        ends = range(_ROWS, len(rows) + 1)
        begin = next((i - _ROWS for i in ends if min(widths[i - _ROWS : i]) == max(widths[i - _ROWS : i]) > 1), 0)
        width = len(rows[begin])
        if begin < _PREAMBLE or (len(rows[0]) == width) != alike:
            continue
        names = begin - 1 if len(rows[begin - 1]) == width else begin
        if names and names < begin and len(rows[names - 1]) == width and _are_units(rows[names]):
            names -= 1
        if alike and not (_are_names(rows[names], delimiter) and _name_more(rows[names], rows[0], delimiter)):
            continue
        return lines[names:]
    return lines


def _are_names(fields: list[str], delimiter: str) -> bool:
    """Whether fields may be names of columns: each has one of its own, and none is a number."""
    named = [field for field in fields if field]
    return len({*named}) == len(fields) and not any(_is_number(field, delimiter) for field in named)


def _name_more(fields: list[str], first: list[str], delimiter: str) -> bool:
    """Whether fields are names rather than those of the first line: which are none, or state fewer units."""
    of_these, of_those = (sum(bool(_IN_BRACKETS.search(field)) for field in row) for row in (fields, first))
    return not _are_names(first, delimiter) or of_these > of_those


def _all_numbers(fields: list[str], delimiter: str) -> bool:
    return any(fields) and all(_is_number(field, delimiter) for field in fields if field)


def _are_units(fields: list[str]) -> bool:
    """Whether most of some fields can be read as units."""
    said = [field.strip("[]() ") for field in fields]
    known = [field in ("", "-") or units.known(field) for field in said]
    return any(said) and 2 * sum(known) > len(known)


def _is_number(field: str, delimiter: str) -> bool:
    return bool(_NUMBER.match(field) or (delimiter != "," and DECIMAL_COMMA.match(field)))


def _commented_header(path: Path, encoding: str, number: int, line: str) -> list[tuple[int, str]]:
    """Return the comment right above the data if it names the columns, where the first line is values already.

    Some of these may be texts, as the names of joints that ``rostopic echo -p`` repeats in every row; a line of names
    has hardly a number.
    """
    if number == 1:
        return []
    with path.open(encoding=encoding, errors="replace") as stream:
        comment = [text for _, text in zip(range(number - 1), stream, strict=False)][-1].strip().lstrip("#% ")
    delimiter = _delimiter(comment, [line])
    names, values = fields_of(comment, delimiter), fields_of(line, delimiter)
    if not len(names) == len(values) > 1:
        return []
    numbers, named = (sum(_is_number(field.strip(), delimiter) for field in fields) for fields in (values, names))
    return [(number - 1, comment)] if 2 * numbers >= sum(map(bool, values)) and not named else []


def _delimiter(header: str, body: list[str]) -> str:
    for candidate in ("\t", ";", ","):
        if candidate in header:
            return candidate
    if "|" in header and (not body or header.count("|") == body[0].count("|")):
        return "|"
    return " " if body and len(header.split()) == len(body[0].split()) > 1 else ","
