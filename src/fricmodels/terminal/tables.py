"""Tables that fit: text folds, numbers are never cut, and columns that find no room follow in a table below."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

_GAP = 2
_LEAST_TEXT = 16


@dataclass(frozen=True)
class Column:
    """A column of a printed table: its title, its cells as text, and whether they are numbers."""

    title: str
    cells: tuple[str, ...]
    number: bool = False


def plain(text: str) -> str:
    """Return text without what would steer a terminal: a name from a file prints as what it is."""
    return "".join(c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in text)


def show_table(console: Console, columns: Sequence[Column], title: str = "") -> None:
    """Print columns as a table no wider than the console.

    The first column says what a row is about. It stands in every part when the columns do not fit side by side.

    Args:
        console: where to print.
        columns: all of the same number of cells; number columns are as wide as their longest cell, text folds.
        title: above the table.
    """
    from rich.text import Text

    if title:
        console.print(Text(plain(title), style="bold"))
    for number, part in enumerate(_parts(columns, console.width)):
        if number:
            console.print()
        console.print(_table(part, console.width))
    if not columns or not columns[0].cells:
        console.print(Text("  none"))


def fits(columns: Sequence[Column], width: int) -> bool:
    """Whether columns stand side by side in so many characters."""
    return len(_parts(columns, width)) < 2


def _parts(columns: Sequence[Column], width: int) -> list[list[Column]]:
    """Distribute columns over as many tables as the width asks for, the first column in each."""
    if not columns:
        return []
    key, *others = columns
    parts = [[key]]
    room = width - _least(key, width, key=True)
    for column in others:
        needed = _GAP + _least(column, width)
        if needed > room and len(parts[-1]) > 1:
            parts.append([key])
            room = width - _least(key, width, key=True)
        parts[-1].append(column)
        room -= needed
    return parts


def _least(column: Column, width: int, *, key: bool = False) -> int:
    """Return the width below which a column becomes unreadable, or a name can no longer be copied."""
    natural = max([longest_word(column.title), *(_width(cell) for cell in column.cells)])
    if column.number:
        return min(natural, width)
    names = key or not any(" " in cell for cell in column.cells)
    longest = natural if key else max(map(longest_word, column.cells), default=0)
    enough = max(_LEAST_TEXT, longest_word(column.title), min(longest, width * 2 // 5) if names else 0)
    return min(natural, enough, width)


def longest_word(text: str) -> int:
    """Return the width of the longest piece that a fold keeps together."""
    return max((_width(piece.rstrip()) for piece in _pieces(text)), default=0)


def _width(text: str) -> int:
    from rich.cells import cell_len

    return cell_len(plain(text))


def _table(columns: Sequence[Column], width: int) -> Any:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    widths = widths_of(columns, width)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, _GAP - 1, 0, 0))
    for column, own in zip(columns, widths, strict=True):
        justify: Any = "right" if column.number else "left"
        table.add_column(Text(fold(column.title, own)), justify=justify, vertical="top", width=own)
    for cells in zip(*(column.cells for column in columns), strict=True):
        failed = any(c.title == "status" and cell.split()[:1] != ["ok"] for c, cell in zip(columns, cells, strict=True))
        folded = (Text(fold(cell, own)) for cell, own in zip(cells, widths, strict=True))
        table.add_row(*folded, style="dim" if failed else None)
    return table


def widths_of(columns: Sequence[Column], width: int) -> list[int]:
    """Return the width of each column: the least, then as wide as cells and titles ask for while there is room."""
    widths = [_least(column, width, key=number == 0) for number, column in enumerate(columns)]
    spare = width - sum(widths) - _GAP * (len(columns) - 1)
    longest = [max((_width(cell) for cell in column.cells), default=0) for column in columns]
    titles = [_width(column.title) for column in columns]
    for wanted in (longest, [math.ceil(title / 2) + 2 for title in titles], titles):
        spare -= _widen(widths, wanted, spare)
    return widths


def _widen(widths: list[int], wanted: Sequence[int], spare: int) -> int:
    """Widen the columns that lack room, all by the same until they have what they want; return how much it took."""
    before = sum(widths)
    while lacking := [i for i, width in enumerate(widths) if width < wanted[i]]:
        share = (spare - (sum(widths) - before)) // len(lacking)
        if share < 1:
            break
        for i in lacking:
            widths[i] += min(share, wanted[i] - widths[i])
    return sum(widths) - before


def fold(text: str, width: int) -> str:
    """Break text into lines of a width: at spaces, after the plus signs of a model's name, or else anywhere.

    A unit in brackets goes on the next line together with the word before it, where both find room there.
    """
    lines = [""]
    for piece in _pieces(plain(text)):
        if _width(lines[-1]) + _width(piece.rstrip()) > width and lines[-1]:
            words, space, symbol = lines[-1].rstrip().rpartition(" ")
            both = bool(space) and piece[0] == "[" and _width(f"{symbol} {piece.rstrip()}") <= width
            lines[-1:] = [words, f"{symbol} "] if both else [lines[-1], ""]
        lines[-1] += piece
        while _width(lines[-1].rstrip()) > width:
            whole = lines.pop()
            cut = next(n for n in range(len(whole), 0, -1) if _width(whole[:n]) <= width or n == 1)
            lines += [whole[:cut], whole[cut:]]
    return "\n".join(line.rstrip() for line in lines)


def _pieces(text: str) -> list[str]:
    """Return what stays together: words, units in brackets (not a remark), the terms of a model's name."""
    return re.findall(r"\[[^\]:;]*\][,;.)]*\s*|[^\s+]*\+|[^\s+]+\s*|\s+", text)
