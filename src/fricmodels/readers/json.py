"""JSON: rows of named or unnamed numbers, or a list of numbers for each name; one document, or one a line."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.errors import InputError
from fricmodels.readers.base import SeveralTables
from fricmodels.readers.vectors import of_one_length, vectors

if TYPE_CHECKING:
    import pandas as pd

RUN = "run"
_LINES = (".jsonl", ".ndjson")


class JsonReader(SeveralTables):
    """JSON documents.

    Samples are a list of objects, ``[{"t": 0.0, "q": 1.2}, …]``, one object a line, or a list for each name, ``{"t":
    [0.0, …], "q": [1.2, …]}``; in the place of a list may be an object of numbered samples, as pandas writes it. They
    may lie in an object beside shorter ones; then its name is left out. What is nested is called ``joint.q``, the parts
    of a vector ``q(1)``, ``q(2)``. Objects with lists that are longer than the list of them are runs. Rows without
    names, ``[[0.0, 1.2], …]``, have columns 1, 2, …; several such tables of one width and of different lengths are
    runs, with their names in the column ``run``.
    """

    name = "json"
    suffixes = (".json", *_LINES)
    summary = "JSON: rows of objects or lists, a list for each name, or an object a line"

    def table_for(self, path: Path, asked: Collection[str]) -> pd.DataFrame:
        """Return the columns as long as those asked for."""
        content = _content(path)
        found = of_one_length(dict(vectors(_columns(content))), asked)
        if found is None:
            raise InputError(f"{path}: holds no lists of numbers; save the samples as a list of objects, or of lists")
        return found

    def place(self, path: Path, row: int) -> str:
        """Return the line where every line is a row, else the row."""
        if path.suffix.lower() not in _LINES:
            return f"row {row + 1}"
        with path.open(encoding="utf-8-sig") as stream:
            numbers = (number for number, line in enumerate(stream, start=1) if line.strip())
            return next((f"line {number}" for i, number in enumerate(numbers) if i == row), f"row {row + 1}")


def _content(path: Path) -> Any:
    """Return what a file holds: of one with an object a line, the list of them.

    Raises:
        InputError: naming the line that is no JSON.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: this is no UTF-8 text; save the file anew") from None
    try:
        return _parsed(path, text, 1)
    except InputError:
        lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
        if len(lines) < 2 or not _is_whole(lines[0][1]):
            raise
    return [_parsed(path, line, number) for number, line in lines]


def _is_whole(line: str) -> bool:
    """Whether a line is a document by itself."""
    try:
        return isinstance(json.loads(line), (dict, list))
    except (json.JSONDecodeError, RecursionError):
        return False


def _parsed(path: Path, text: str, line: int) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"{path}: line {line + error.lineno - 1} is no JSON: {error.msg}; repair that line") from None
    except RecursionError:
        raise InputError(f"{path}: is nested too deeply for a table of samples") from None


def _columns(content: Any) -> Mapping[str, Any]:
    """Return arrays by name, nested as the objects are."""
    content = _unnumbered(content)
    if isinstance(content, list):
        table = _of_rows(content)
        return table if isinstance(table, Mapping) else {} if table is None else _numbered(table)
    if not isinstance(content, dict):
        return {}
    tables = {name: table for name, value in content.items() if (table := _matrix(value)) is not None}
    lengths, widths = ({table.shape[axis] for table in tables.values()} for axis in (0, 1))
    if len(lengths) > 1 and len(widths) == 1:  # of one length they would be vectors of the same samples
        names = np.repeat(list(tables), [len(table) for table in tables.values()])
        return {**_numbered(np.vstack(list(tables.values()))), RUN: names}
    found = {name: part for name, value in content.items() if (part := _part(value)) is not None}
    longest = max(found, key=lambda name: _length(found[name]), default="")
    samples = found.get(longest)
    others = max((_length(part) for name, part in found.items() if name != longest), default=0)
    return samples if isinstance(samples, Mapping) and _length(samples) > others else found


def _length(part: Any) -> int:
    return max(map(_length, part.values())) if isinstance(part, Mapping) else len(part)


def _unnumbered(content: Any) -> Any:
    """Return the list of samples of an object that has them by their number; anything else as it is."""
    numbered = isinstance(content, dict) and len(content) > 1 and all(name.isdecimal() for name in content)
    return [*content.values()] if numbered else content


def _numbered(table: Any) -> dict[str, Any]:
    columns = table[:, None] if table.ndim == 1 else table
    return {str(i): column for i, column in enumerate(columns.T, start=1)}


def _part(value: Any) -> Any:
    """Return an array, or arrays by name; ``None`` for what is neither."""
    value = _unnumbered(value)
    if isinstance(value, dict):
        return {name: part for name, of in value.items() if (part := _part(of)) is not None} or None
    return _of_rows(value) if isinstance(value, list) else None


def _of_rows(rows: Sequence[Any]) -> Any:
    """Return a list of objects as arrays by name, one of numbers or of lists as an array; ``None`` for any other."""
    if not rows:
        return None
    if not all(isinstance(row, dict) for row in rows):
        return _array(rows)
    if (runs := _of_runs(rows)) is not None:
        return runs
    names = dict.fromkeys(name for row in rows for name in row)
    parts = {name: _of_rows([row.get(name) for row in rows]) for name in names}
    return {name: part for name, part in parts.items() if part is not None} or None


def _of_runs(runs: Sequence[Mapping[str, Any]]) -> dict[str, Any] | None:
    """Return arrays by name of a list of objects that hold lists longer than it; ``None`` for any other.

    Each object is a run then, of those of its lists that are as long as its longest.
    """
    lists = [{name: value for name, value in run.items() if isinstance(value, list)} for run in runs]
    longest = [max(map(len, of.values()), default=0) for of in lists]
    if min(longest) <= len(runs):
        return None
    found = [
        {name: part for name, value in of.items() if len(value) == rows and (part := _of_rows(value)) is not None}
        for of, rows in zip(lists, longest, strict=True)
    ]
    names = [name for name in found[0] if all(isinstance(of.get(name), np.ndarray) for of in found)]
    alike = [name for name in names if len({of[name].shape[1:] for of in found}) == 1]
    table = {name: np.concatenate([of[name] for of in found]) for name in alike}
    number = {RUN: np.repeat(np.arange(len(runs)), longest)} if len(runs) > 1 and RUN not in table else {}
    return {**table, **number} if table else None


def _matrix(value: Any) -> Any:
    """Return a list of equally long lists of numbers, longer than these, as an array; ``None`` for any other."""
    found = _array(value) if isinstance(value, list) and value and isinstance(value[0], list) else None
    return found if found is not None and found.ndim == 2 and 1 < found.shape[1] < len(found) else None


def _array(values: Sequence[Any]) -> Any:
    """Return a list as an array, with NaN where there is nothing; ``None`` where its parts are not alike."""
    try:
        found = np.array([math.nan if value is None else value for value in values])
    except ValueError:
        return None
    return found if found.dtype.kind in "fiubU" else None
