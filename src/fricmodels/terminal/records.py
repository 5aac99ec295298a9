"""Lists of names too long for a table: each name on a line of its own, what is said of it below, nothing broken."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fricmodels.terminal.tables import Column, fold, longest_word, plain, widths_of

if TYPE_CHECKING:
    from rich.console import Console

_INDENT = 2


def breaks(columns: Sequence[Column], width: int) -> bool:
    """Whether a table of such columns breaks a word, or does not fit side by side."""
    given = widths_of(columns, width)
    longest = (max((longest_word(cell) for cell in column.cells), default=0) for column in columns)
    return sum(given) + 2 * (len(given) - 1) > width or any(one < own for one, own in zip(given, longest, strict=True))


def show_records(console: Console, columns: Sequence[Column]) -> None:
    """Print each row as a block: the first cell, and the others below it with their titles.

    Args:
        console: where to print.
        columns: all of the same number of cells; empty cells are left out.
    """
    from rich.text import Text

    key, *others = columns
    beside = max(len(column.title) for column in others) + _INDENT
    for name, *cells in zip(key.cells, *(column.cells for column in others), strict=True):
        console.print(Text(plain(name), style="bold"), soft_wrap=True)
        for column, cell in zip(others, cells, strict=True):
            lines = fold(cell, max(console.width - _INDENT - beside, _INDENT)).split("\n") if cell else []
            for number, line in enumerate(lines):
                title = "" if number else column.title
                console.print(Text(f"{'':{_INDENT}}{title:{beside}}{line}"), soft_wrap=True)
