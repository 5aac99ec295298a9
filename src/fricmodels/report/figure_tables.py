"""Tables that say the same as a figure, and what its axes are called."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.report.page import Table, table
from fricmodels.report.wording import number

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_ROWS = 25
"""Rows of a table that stands for a figure."""
_GRID = 8
"""Rows and columns of a table that stands for a map."""


def points_of(figure: Figure) -> Table | None:
    """Return a few points of each curve of a figure as a table; the greatest value of a curve is among them."""
    curves = [
        trace
        for trace in figure.data
        if trace.type == "scatter"
        and trace.name
        and trace.fill is None
        and trace.x is not None
        and len(trace.x)
        and trace.x[0] is not None
    ]
    rows = []
    for trace in curves:
        x, y = np.asarray(trace.x, dtype=float), np.asarray(trace.y, dtype=float)
        finite = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        if not len(finite):
            continue
        few = np.linspace(0, len(finite) - 1, min(len(finite), max(4, _ROWS // len(curves)))).round().astype(int)
        chosen = np.union1d(finite[few], finite[[int(np.argmax(np.abs(y[finite])))]])
        axes = [figure.layout[(getattr(trace, f"{axis}axis") or axis).replace(axis, f"{axis}axis")] for axis in "xy"]
        units = [axis_unit(axis) for axis in axes]
        rows += [
            (
                html.unescape(str(trace.name)),
                f"{number(float(x[i]))} {units[0]}".strip(),
                f"{number(float(y[i]))} {units[1]}".strip(),
            )
            for i in chosen
        ]
    across, up = _titles(figure, "x"), _titles(figure, "y")
    return table("Some points of the curves", {"curve": False, across: True, up: True}, rows) if rows else None


def cells_of(figure: Figure) -> Table | None:
    """Return a map as a coarse table: means of its cells, rows from the top."""
    trace, meta = figure.data[0], figure.layout.meta or {}
    grid = np.asarray(trace.customdata if "cells" in meta else trace.z, dtype=float)
    grid = np.where(np.isfinite(np.asarray(trace.z, dtype=float)), grid, np.nan)
    rows, columns = (np.array_split(np.arange(size), min(size, _GRID)) for size in grid.shape)
    x, y = np.asarray(trace.x, dtype=float), np.asarray(trace.y, dtype=float)
    titles = {f"{axis_title(figure.layout.yaxis)} ↓ {axis_title(figure.layout.xaxis)} →": True}
    titles |= {number(float(x[part].mean())): True for part in columns}
    body = [
        (number(float(y[part].mean())), *(_mean(grid[np.ix_(part, other)]) for other in columns)) for part in rows[::-1]
    ]
    return table(meta.get("cells") or f"Mean residual [{unit_shown(figure)}]", titles, body)


def _mean(cells: Array) -> str:
    known = cells[np.isfinite(cells)]
    return number(float(known.mean()), 2) if len(known) else "–"


def _titles(figure: Figure, letter: str) -> str:
    """Return the titles of all horizontal or vertical axes of a figure, each once."""
    names = sorted(str(name) for name in figure.layout if str(name).startswith(f"{letter}axis"))
    return " / ".join(dict.fromkeys(title for name in names if (title := axis_title(figure.layout[name]))))


def axis_title(axis: Any) -> str:
    """Return the title of an axis without its unit."""
    return html.unescape(str(axis.title.text or "")).partition(" [")[0]


def axis_unit(axis: Any) -> str:
    """Return the unit in the title of an axis."""
    return html.unescape(str(axis.title.text or "")).partition(" [")[2].removesuffix("]")


def unit_shown(figure: Figure, axis: str = "") -> str:
    """Return the unit of an axis, or of what a figure shows: that of the colours of a map, of the curves' heights."""
    if axis:
        return axis_unit(figure.layout[axis])
    trace = figure.data[0]
    return axis_unit(trace.colorbar) if trace.type == "heatmap" else axis_unit(figure.layout.yaxis)
