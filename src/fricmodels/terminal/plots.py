"""Small plots made of characters: what is drawn last lies on top, so that no colour is needed to tell lines apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fricmodels.arrays import Array, Index
from fricmodels.terminal.tables import plain

if TYPE_CHECKING:
    from rich.console import Console


_EIGHTHS = " ▏▎▍▌▋▊▉"
_WIDEST, ROWS = 100, 13


@dataclass(frozen=True)
class Band:
    """A line through samples in their order, drawn as all the values that it takes within a column of characters."""

    label: str
    mark: str
    x: Array
    y: Array


@dataclass(frozen=True)
class Marks(Band):
    """Points, each on its own."""


def bar(share: float, width: int, *, ascii_only: bool = False) -> str:
    """Return a bar of ``share`` (0 to 1) of the width, in eighths of a character; anything above 0 is visible."""
    eighths = round(8 * width * min(max(share, 0.0), 1.0))
    if ascii_only:
        return "#" * max(round(eighths / 8), int(share > 0))
    whole, rest = divmod(max(eighths, int(share > 0)), 8)
    return "█" * whole + (_EIGHTHS[rest] if rest else "")


def show_plot(console: Console, series: Sequence[Band], x_title: str, y_title: str, rows: int = ROWS) -> None:
    """Print series over each other, with both axes; no wider than the console, peaks are kept.

    Args:
        console: where to print.
        series: what is drawn, the top one last.
        x_title, y_title: quantity and unit.
        rows: of characters.
    """
    from rich.text import Text

    finite = [(s, np.isfinite(s.x) & np.isfinite(s.y)) for s in series]
    drawn = [(s, s.x[good], s.y[good]) for s, good in finite if good.any()]
    if not drawn:
        return
    ascii_only = console.options.ascii_only
    left, right = _limits([x for _, x, _ in drawn])
    low, high = _limits([y for _, _, y in drawn])
    ticks = _ticks(low, high, rows)
    margin = max(len(tick) for tick in ticks.values())
    columns = max(min(console.width, _WIDEST) - margin - 2, 8)
    cells = np.full((rows, columns), " ")
    if low < 0 < high:
        cells[_row(0.0, low, high, rows)] = "-" if ascii_only else "╌"
    for one, x, y in drawn:
        column = np.clip(((x - left) / (right - left) * columns).astype(int), 0, columns - 1)
        if isinstance(one, Marks):
            cells[_rows(y, low, high, rows), column] = one.mark
        else:
            _draw_band(cells, one.mark, column, _rows(y, low, high, rows))
    legend = "   ".join(f"{one.mark} {one.label}" for one, _, _ in drawn)
    console.print(Text(plain(f"{y_title}   {legend}")))
    upright, corner, across = ("|", "+", "-") if ascii_only else ("│", "└", "─")
    for number, row in enumerate(cells):
        console.print(Text(f"{ticks.get(number, ''):>{margin}} {upright}{''.join(row)}".rstrip(), no_wrap=True))
    console.print(Text(f"{'':>{margin}} {corner}{across * columns}", no_wrap=True))
    first, last = _number(left), _number(right)
    middle = plain(x_title)
    spare = columns - len(first) - len(last) - len(middle)
    below = [f"{first}{' ' * max(columns - len(first) - len(last), 1)}{last}", f"{middle:^{columns}}"]
    if spare >= 2:
        below = [f"{first}{' ' * (spare // 2)}{middle}{' ' * (spare - spare // 2)}{last}"]
    for line in below:
        console.print(Text(f"{'':>{margin + 2}}{line}".rstrip(), no_wrap=True))


def _draw_band(cells: NDArray[np.str_], mark: str, column: Index, row: Index) -> None:
    """Mark, in every column, the rows from the least to the greatest that the line passes."""
    width = cells.shape[1]
    top, bottom = np.full(width, len(cells)), np.full(width, -1)
    np.minimum.at(top, column, row)
    np.maximum.at(bottom, column, row)
    # From one column to the next the line goes on: each reaches half of the way to its neighbour.
    step = np.flatnonzero(np.diff(column) == 1)
    middle = (row[step] + row[step + 1]) // 2
    for at, reach in ((column[step], middle), (column[step + 1], middle)):
        np.minimum.at(top, at, reach)
        np.maximum.at(bottom, at, reach)
    rows = np.arange(len(cells))[:, None]
    cells[(rows >= top) & (rows <= bottom)] = mark


def _limits(values: Sequence[Array]) -> tuple[float, float]:
    low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
    if high > low:
        return low, high
    pad = abs(low) or 1.0
    return low - pad, high + pad


def _rows(y: Array, low: float, high: float, rows: int) -> Index:
    return np.asarray(np.rint((high - y) / (high - low) * (rows - 1)), dtype=np.int64)


def _row(y: float, low: float, high: float, rows: int) -> int:
    return int(_rows(np.array([y]), low, high, rows)[0])


def _ticks(low: float, high: float, rows: int) -> dict[int, str]:
    """Return the numbers at the axis by row: both ends, and zero where it is between them, or the middle."""
    middle = 0.0 if low < 0 < high else (low + high) / 2
    ticks = {_row(middle, low, high, rows): _number(middle)}
    return {**ticks, 0: _number(high), rows - 1: _number(low)}


def _number(value: float) -> str:
    return f"{value:.3g}"
