"""Figures of a comparison, each with its message in words and its table."""

from __future__ import annotations

import html
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.report.page import Picture, Table, table
from fricmodels.report.wording import listed, number, percent

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.term import Effect


_ROWS = 25
"""Rows of a table that stands for a figure."""
_GRID = 8
"""Rows and columns of a table that stands for a map."""
_MOSTLY = 0.5
"""A map changes mostly with one quantity when that alone makes this share of its variance."""


def over_time(comparison: Comparison, *, kept_back: bool = True) -> Picture:
    """Return torque over time, measured and modelled.

    Args:
        comparison: a model and a recording.
        kept_back: whether part of the recording took no part in fitting; where not, its second part is the first again.
    """
    from fricmodels.report import figures

    errors = comparison.errors
    words = f"RMS error {errors.averaged}: {percent(errors.percent)} of the RMS torque on what was fitted"
    if kept_back:
        figure = figures.overlay(comparison)
        words += f", {percent(errors.held_out_percent)} on what was kept back (shaded)"
    else:
        from fricmodels.report.figures.samples import Samples

        samples = Samples.of(comparison)
        first = samples.place[~samples.kept_back]
        figure = figures.overlay(comparison, (float(first[0]), float(first[-1])))
    title = f"{words_of('torque', comparison).capitalize()} over time"
    return Picture(title, f"{words}. {where_words(comparison)}", figure, points_of(figure))


def curve(comparison: Comparison, title: str = "Friction against velocity") -> Picture:
    """Return friction against velocity, measured and modelled."""
    from fricmodels.report import figures

    figure = figures.friction_curve(comparison)
    words = (
        "The cloud is what was measured, less everything in the model that is not friction; the line is the model. "
        "Where the cloud leaves the line, friction is not what the model says."
    )
    return Picture(title, words, figure, points_of(figure))


def by_regime(comparison: Comparison) -> Picture:
    """Return in which regimes of motion the error lies."""
    from fricmodels.report import figures

    words = where_words(comparison, most=3)
    return Picture("Error by regime", words, figures.error_shares(comparison), regimes(comparison))


def marks(comparison: Comparison) -> list[Picture]:
    """Return the residual over pairs of channels, its spectrum and the reversals; what was not recorded is left out."""
    from fricmodels.report import figures

    found = [mark(comparison, channel) for channel in figures.residual_maps(comparison)]
    spectrum = figures.residual_spectrum(comparison)
    found.append(Picture("Spectrum of the residual", spectrum_words(spectrum), spectrum, points_of(spectrum)))
    try:
        loops = figures.hysteresis(comparison)
    except InputError:
        return found  # a drive that never reverses has no loops
    return [*found, Picture("Friction around reversals", _LOOPS, loops, points_of(loops))]


def mark(comparison: Comparison, channel: str) -> Picture:
    """Return the map of the residual over velocity and another channel."""
    from fricmodels.report import figures

    figure = figures.residual_map(comparison, "velocity", channel)
    return Picture(
        f"Residual over velocity and {words_of(channel, comparison)}", map_words(figure), figure, cells_of(figure)
    )


def evidence(comparison: Comparison, effect: Effect) -> Picture:
    """Return the picture in which the mark of a missing effect is seen best.

    Periodic effects show in the spectrum, others over the signal that they depend on, and what depends on the velocity
    alone in the friction curve.

    Args:
        comparison: the model without the effect.
        effect: what is missing.
    """
    from fricmodels.model import Model
    from fricmodels.recording import channel_of
    from fricmodels.report import figures

    model = Model.only(effect)
    name = comparison.drive.model.name
    if any(p.periodic for p in effect.parameters):
        spectrum = figures.residual_spectrum(comparison)
        return Picture(
            f"Its mark: the spectrum of what {name} leaves over",
            spectrum_words(spectrum),
            spectrum,
            points_of(spectrum),
        )
    if model.states:
        with suppress(InputError):
            loops = figures.hysteresis(comparison)
            return Picture(f"Its mark: friction around reversals beside {name}", _LOOPS, loops, points_of(loops))
    mapped = figures.residual_maps(comparison)
    channel = next((channel_of(s) for s in sorted(model.needs - {"velocity"}) if channel_of(s) in mapped), None)
    if channel is None:
        return curve(comparison, f"Its mark: friction against velocity beside {name}")
    found = mark(comparison, channel)
    return replace(found, title=f"Its mark: what {name} leaves over velocity and {words_of(channel, comparison)}")


_LOOPS = (
    "Friction before and after changes of direction, and how it builds up along the way. Where the branches measured "
    "part and those modelled do not, friction remembers: over a fixed distance it is presliding, over a fixed time lag."
)


def regimes(comparison: Comparison) -> Table:
    """Return the table of regimes, the one with the largest excess of error first."""
    unit = "N m" if comparison.drive.motion is Motion.ROTARY else "N"
    titles = {"regime": False, "squared error": True, "samples": True, f"RMS error [{unit}]": True}
    rows = [
        (
            row.regime,
            f"{100 * row.share_of_squared_error:.1f} %",
            f"{100 * row.share_of_samples:.1f} %",
            number(row.rms_torque_error),
        )
        for row in comparison.where
    ]
    return table("Share of the squared error and of the samples, by regime of motion", titles, rows)


def words_of(channel: str, comparison: Comparison) -> str:
    """Return the name of a channel in words; a torque is a force on a linear axis."""
    text = channel.replace("_", " ")
    return text if comparison.drive.motion is Motion.ROTARY else text.replace("torque", "force")


def where_words(comparison: Comparison, most: int = 1) -> str:
    """Say in which regimes the error exceeds their share of the samples."""
    rows = [row for row in comparison.where if row.share_of_squared_error > row.share_of_samples][:most]
    parts = [
        f"{row.regime} ({100 * row.share_of_squared_error:.0f} % of the squared error in "
        f"{100 * row.share_of_samples:.0f}\u00a0% of the samples)"
        for row in rows
    ]
    return f"The error is concentrated at {listed(parts)}." if parts else "The error is spread evenly."


def map_words(figure: Figure) -> str:
    """Say with which of its two axes a map changes."""
    grid = np.asarray(figure.data[0].z, dtype=float)
    known = np.isfinite(grid)
    if not known.any():
        return "There is too little motion for a map."
    titles = [_title(axis) for axis in (figure.layout.xaxis, figure.layout.yaxis)]
    least, most = float(grid[known].min()), float(grid[known].max())
    spread = f"The mean residual of a cell lies between {number(least)} and {number(most)} {_unit(figure)}"
    shares = [_explained(grid, known, axis) for axis in (0, 1)]
    best = int(np.argmax(shares))
    if shares[best] > _MOSTLY and shares[1 - best] < _MOSTLY:
        return f"{spread}, and changes mostly with {titles[best]}, whatever the {titles[1 - best]}."
    return f"{spread}."


def _explained(grid: Array, known: Mask, axis: int) -> float:
    """Return the share of a map's variance that means along one axis explain, beyond what as many of anything would."""
    count = known.sum(axis=axis)
    mean = np.where(known, grid, 0.0).sum(axis=axis) / np.maximum(count, 1)
    rest = np.where(known, grid - np.expand_dims(mean, axis), 0.0)
    cells, used = int(known.sum()), int(np.count_nonzero(count))
    total = float(np.var(grid[known]))
    if cells <= used or total == 0:
        return 0.0
    return 1.0 - float(np.sum(rest**2)) / total * (cells - 1) / (cells - used) / cells


def spectrum_words(figure: Figure) -> str:
    """Say where a spectrum has its greatest line."""
    curves = [
        (np.asarray(trace.x, dtype=float), np.asarray(trace.y, dtype=float), str(trace.name))
        for trace in figure.data
        if len(trace.x) and "noise" not in str(trace.name)
    ]
    if not curves:
        return "The recording is too short for a spectrum."
    x, y, name = max(curves, key=lambda curve: float(curve[1].max()))
    top = int(np.argmax(y))
    text = f"The strongest line, {name}, stands at {number(float(x[top]))} {_unit(figure, 'xaxis')}"
    over_position = "order" in _title(figure.layout.xaxis)
    meaning = " A sharp line at a fixed order turns with the drive: poles, slots, teeth, an eccentric wheel."
    return f"{text}, with an amplitude of {number(float(y[top]))} {_unit(figure)}.{meaning if over_position else ''}"


def points_of(figure: Figure) -> Table | None:
    """Return a few points of each curve of a figure as a table; the greatest value of a curve is among them."""
    curves = [
        trace
        for trace in figure.data
        if trace.type == "scatter" and trace.fill is None and trace.x is not None and trace.x[0] is not None
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
        units = [_unit_of(axis) for axis in axes]
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
    trace = figure.data[0]
    grid = np.asarray(trace.z, dtype=float)
    rows, columns = (np.array_split(np.arange(size), min(size, _GRID)) for size in grid.shape)
    x, y = np.asarray(trace.x, dtype=float), np.asarray(trace.y, dtype=float)
    titles = {f"{_title(figure.layout.yaxis)} ↓ {_title(figure.layout.xaxis)} →": True}
    titles |= {number(float(x[part].mean())): True for part in columns}
    body = [
        (number(float(y[part].mean())), *(_mean(grid[np.ix_(part, other)]) for other in columns)) for part in rows[::-1]
    ]
    return table(f"Mean residual [{_unit(figure)}]", titles, body)


def _mean(cells: Array) -> str:
    known = cells[np.isfinite(cells)]
    return number(float(known.mean()), 2) if len(known) else "–"


def _titles(figure: Figure, letter: str) -> str:
    """Return the titles of all horizontal or vertical axes of a figure, each once."""
    names = sorted(str(name) for name in figure.layout if str(name).startswith(f"{letter}axis"))
    return " / ".join(dict.fromkeys(title for name in names if (title := _title(figure.layout[name]))))


def _title(axis: Any) -> str:
    """Return the title of an axis without its unit."""
    return html.unescape(str(axis.title.text or "")).partition(" [")[0]


def _unit_of(axis: Any) -> str:
    return html.unescape(str(axis.title.text or "")).partition(" [")[2].removesuffix("]")


def _unit(figure: Figure, axis: str = "") -> str:
    """Return the unit of an axis, or of what a figure shows: that of the colours of a map, of the curves' heights."""
    if axis:
        return _unit_of(figure.layout[axis])
    trace = figure.data[0]
    return _unit_of(trace.colorbar) if trace.type == "heatmap" else _unit_of(figure.layout.yaxis)
