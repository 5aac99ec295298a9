"""Where the residual lies: maps over pairs of channels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.errors import InputError
from fricmodels.report.figures.grid import even_edges
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, graph_objects, styled, words

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison

CELLS = 48
"""Most cells along each axis."""
_FEWER = (CELLS, 32, 24, 16, 12, 8)
_ENOUGH = 0.6
"""Share of the visited cells that are to hold an independent value; else the cells are larger."""
_WEAK = 0.35
"""Opacity of cells that hold less."""
AGAINST = ("position", "acceleration", "load_torque", "temperature", "time")
"""Channels over which, with the velocity, the residual is mapped."""
_EXCERPT = 2**16
_OUTER = 0.001
_COLOURED = 0.98
"""Share of the cells whose colour is not at the end of the scale."""


@dataclass(frozen=True)
class Cells:
    """Binned residual.

    Attributes:
        x_edges, y_edges: borders of the cells.
        mean: mean residual [N m or N], shape (rows, columns), NaN where there is no sample.
        standard_error: of the mean, from the scatter within cells and the time for which residuals stay alike.
        count: samples in each cell.
        independent: about how many independent values that is.
    """

    x_edges: Array
    y_edges: Array
    mean: Array
    standard_error: Array
    count: Index
    independent: Array


def binned_mean(x: Array, y: Array, values: Array, piece: Index, cells: int = CELLS) -> Cells:
    r"""Return the mean of values in the cells of a grid over x and y.

    The standard error of a mean of n samples is :math:`s\sqrt{T/n}` with the pooled standard deviation s within the
    cells and the number T of samples over which what is left beside the cells' means is correlated.

    Args:
        x, y: where each sample lies, shape (N,).
        values: in order of time, shape (N,).
        piece: uninterrupted pieces of the samples.
        cells: along each axis.
    """
    edges = [_edges(each, cells) for each in (x, y)]
    places = [
        np.clip(np.searchsorted(edge, each, side="right") - 1, 0, len(edge) - 2)
        for edge, each in zip(edges, (x, y), strict=True)
    ]
    columns, rows = len(edges[0]) - 1, len(edges[1]) - 1
    cell = places[1]
    cell *= columns
    cell += places[0]
    del places
    count = np.bincount(cell, minlength=rows * columns)
    total = np.bincount(cell, weights=values, minlength=rows * columns)
    mean = np.divide(total, count, out=np.full(rows * columns, np.nan), where=count > 0)
    rest = mean[cell]
    np.subtract(values, rest, out=rest)
    freedom = max(1, len(values) - int(np.count_nonzero(count)))
    deviation = float(np.sqrt(np.sum(rest**2) / freedom))
    alike = correlation_length(rest, piece)
    independent = count / alike
    error = np.divide(deviation, np.sqrt(independent), out=np.full(len(count), np.nan), where=count > 0)
    shape = (rows, columns)
    return Cells(
        edges[0], edges[1], mean.reshape(shape), error.reshape(shape), count.reshape(shape), independent.reshape(shape)
    )


def _edges(values: Array, cells: int) -> Array:
    """Return even borders of cells; what lies beyond all but a thousandth falls into the outer ones."""
    low, high = (float(q) for q in np.quantile(values, [_OUTER / 2, 1 - _OUTER / 2]))
    if not high > low:
        low, high = float(values.min()), float(values.max())
    return even_edges(low, high, cells)


class Pieces:
    """Finds the longest piece of samples that come in blocks."""

    def __init__(self) -> None:
        self._count = 0
        self._starts = [np.zeros(0, dtype=np.int64)]
        self._last: Index = np.zeros(0, dtype=np.int64)

    def follow(self, piece: Index) -> None:
        """Take further samples: the number of the piece that each belongs to, shape (N,)."""
        joined = np.concatenate([self._last, piece])
        starts = np.flatnonzero(joined[1:] != joined[:-1]) + 1
        self._starts.append(starts + self._count - len(self._last))
        self._count, self._last = self._count + len(piece), joined[-1:]

    def beginning_of_longest(self) -> slice:
        """Return which samples the longest piece is, the first of those as long, or its beginning."""
        starts = np.concatenate([[0], *self._starts])
        sizes = np.diff(np.append(starts, self._count))
        longest = int(np.argmax(sizes))
        return slice(int(starts[longest]), int(starts[longest]) + min(int(sizes[longest]), _EXCERPT))


def correlation_length(values: Array, piece: Index) -> float:
    """Return over how many samples a signal resembles itself, from the longest piece, or its beginning."""
    pieces = Pieces()
    pieces.follow(piece)
    return resemblance(values[pieces.beginning_of_longest()])


def resemblance(part: Array) -> float:
    """Return over how many samples a signal resembles itself: the sum of its autocorrelation up to its first zero."""
    part = part - part.mean()
    count = len(part)
    power = np.abs(np.fft.rfft(part, 2 * count)) ** 2
    correlation = np.fft.irfft(power)[:count]
    if not correlation[0] > 0:
        return 1.0
    correlation = correlation / correlation[0]
    below = np.flatnonzero(correlation <= 0)
    stop = int(below[0]) if len(below) else count
    return float(max(1.0, 1.0 + 2.0 * np.sum(correlation[1:stop])))


def residual_map(comparison: Comparison, x: str = "velocity", y: str = "position") -> Figure:
    """Draw the mean residual over two channels: blue where the model asks for too much torque, orange for too little.

    The cells are as small as the data allow. Those with less than one independent value are pale.

    Args:
        comparison: a model and a recording.
        x, y: channels of the recording.

    Raises:
        InputError: when the recording lacks one of the channels, or it never changes.
    """
    samples = Samples.of(comparison)
    places = [_channel(samples, name) for name in (x, y)]
    cells = _as_fine_as_allowed(places[0], places[1], samples)
    visited, known = cells.count > 0, cells.independent >= 1
    scattered = visited & (cells.standard_error > 0)
    ratio = np.divide(cells.mean, cells.standard_error, out=np.full(known.shape, np.nan), where=scattered)
    mean = np.where(visited, cells.mean, np.nan)
    sure = known if known.any() else visited
    finite = np.abs(mean[sure & np.isfinite(mean)])
    limit = float(np.quantile(finite, _COLOURED)) if np.any(finite > 0) else 1.0
    figure = graph_objects().Figure()
    for some, opacity, named in ((sure, 1.0, "mean residual"), (visited & ~sure, _WEAK, "few samples")):
        own = np.where(some, mean, np.nan).astype(np.float32)
        held = np.where(some[..., None], np.dstack([mean, ratio, cells.count]), np.nan).astype(np.float32)
        if opacity < 1 and not some.any():
            continue
        figure.add_heatmap(
            x=(cells.x_edges[:-1] + cells.x_edges[1:]) / 2,
            y=(cells.y_edges[:-1] + cells.y_edges[1:]) / 2,
            z=own,
            name=named,
            opacity=opacity,
            showscale=opacity == 1,
            customdata=held,
            zmin=-limit,
            zmax=limit,
            colorscale=[
                [0, LIGHT["below_far"]],
                [0.25, LIGHT["below"]],
                [0.5, LIGHT["none"]],
                [0.75, LIGHT["above"]],
                [1, LIGHT["above_far"]],
            ],
            hoverongaps=False,
            colorbar={
                "orientation": "h",
                "thickness": 10,
                "len": 1,
                "x": 0.5,
                "y": 0,
                "yanchor": "bottom",
                "yref": "container",
                "title": {"text": samples.torque_axis("mean residual"), "side": "bottom", "font": {"size": 12}},
                "tickfont": {"size": 11},
                "exponentformat": "power",
                "outlinewidth": 0,
            },
            hovertemplate=(
                f"%{{customdata[0]:.3g}} {samples.torque_unit}<br>%{{customdata[1]:.1f}} standard errors<br>"
                f"%{{customdata[2]:.0f}} samples<br>{words(x, samples.motion)} %{{x:.3g}} {samples.unit(x)}<br>"
                f"{words(y, samples.motion)} %{{y:.3g}} {samples.unit(y)}<extra></extra>"
            ),
        )
    figure.update_xaxes(title_text=samples.axis(x), range=_held(cells.x_edges, visited.sum(axis=0) > 0))
    figure.update_yaxes(title_text=samples.axis(y), range=_held(cells.y_edges, visited.sum(axis=1) > 0))
    name = f"Residual over {words(x, samples.motion)} and {words(y, samples.motion)}"
    styled(figure, name, samples.subtitle, height=480)
    figure.update_layout(margin_b=112)
    return figure


def _as_fine_as_allowed(x: Array, y: Array, samples: Samples) -> Cells:
    """Return the finest cells of which most hold an independent value."""
    for count in _FEWER:
        cells = binned_mean(x, y, samples.error, samples.recording.run, count)
        visited = int(np.count_nonzero(cells.count))
        if np.count_nonzero(cells.independent >= 1) >= _ENOUGH * visited:
            break
    return cells


def _held(edges: Array, visited: Mask) -> list[float]:
    """Return the range of an axis that the visited cells take."""
    held = np.flatnonzero(visited)
    return [float(edges[held[0]]), float(edges[held[-1] + 1])]


def changing(comparison: Comparison) -> list[str]:
    """Return the channels beside the velocity that change."""
    recording = Samples.of(comparison).recording
    return [name for name in AGAINST if name in recording and float(np.ptp(recording[name])) > 0]


def _channel(samples: Samples, name: str) -> Array:
    values = samples.velocity if name == "velocity" else samples.recording[name]
    if not float(np.ptp(values)) > 0:
        raise InputError(f"the channel '{name}' of recording '{samples.recording.name}' never changes; map another")
    return values
