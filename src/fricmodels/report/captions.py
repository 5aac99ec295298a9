"""What a figure shows, in words that are computed from it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array, Mask, rms
from fricmodels.diagnosis.where import in_words
from fricmodels.dimension import FORCE, VELOCITY, Motion
from fricmodels.report.figure_tables import axis_title, axis_unit, unit_shown
from fricmodels.report.figures.spectrum import strongest
from fricmodels.report.wording import listed, number
from fricmodels.results.words import figures

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from fricmodels.diagnosis.comparison import Comparison

_MOSTLY = 0.5
"""A map changes mostly with one quantity when that alone makes this share of its variance."""
_HARDLY = 0.2
"""It hardly changes with the other one when that alone makes no more than this share of its variance."""
_LEAST_LINES, _SEVERAL = 6, 4
"""Rows and columns, and cells in each, of which a map has at least as many where words say how it changes."""
_BRANCH = 3
"""Means on one side of zero from which two branches are compared."""
_NONE = 1e-3
"""Share of a measured difference below which the modelled one is said to be none."""
_LEAST_PART = 0.01
"""Percent of the samples below which a share is given as this."""
_CLEARLY = 1.1
"""Times the whole error from which the error of a regime is called larger."""


def words_of(channel: str, comparison: Comparison) -> str:
    """Return the name of a channel in words; a torque is a force on a linear axis."""
    text = channel.replace("_", " ")
    return text if comparison.drive.motion is Motion.ROTARY else text.replace("torque", "force")


def where_words(comparison: Comparison, most: int = 1) -> str:
    """Say in which regimes the RMS error is largest, and how many of the samples lie there.

    Args:
        comparison: a model and a recording.
        most: regimes that are named at most, each clearly above the error over all that was fitted.
    """
    whole = comparison.errors.SI
    rows = sorted(comparison.where, key=lambda row: -row.rms_torque_error)[:most]
    rows = [row for row in rows if row.rms_torque_error > _CLEARLY * whole]
    if not rows:
        return "The error is about the same in all regimes of motion."
    unit = FORCE.unit(comparison.drive.motion)
    parts: list[str] = []
    for row in rows:
        share = f"{figures(max(100 * row.share_of_samples, _LEAST_PART))} %{'' if parts else ' of the samples'}"
        parts.append(f"{in_words(row.regime)} ({number(row.rms_torque_error)} {unit} RMS, {share})")
    over = "all other samples" if comparison.drive.model.known.fixed else "all that was fitted"
    return f"The error is largest {listed(parts)}; over {over} it is {number(whole)} {unit}."


def map_words(figure: Figure) -> str:
    """Say with which of its two axes a map changes."""
    grid = np.asarray(figure.data[0].z, dtype=float)
    known = np.isfinite(grid)
    if not known.any():
        return "There is too little motion for a map."
    titles = [axis_title(axis) for axis in (figure.layout.xaxis, figure.layout.yaxis)]
    least, most = float(grid[known].min()), float(grid[known].max())
    spread = f"The mean residual of a cell lies between {number(least)} and {number(most)} {unit_shown(figure)}"
    shares = [_explained(grid, known, axis) for axis in (0, 1)]
    best = int(np.argmax(shares))
    filled = all(int(np.count_nonzero(known.sum(axis=axis) >= _SEVERAL)) >= _LEAST_LINES for axis in (0, 1))
    if filled and shares[best] > _MOSTLY and shares[1 - best] < _HARDLY:
        part = f"{100 * min(shares[best], 1.0):.0f} %"
        return f"{spread}; {titles[best]} alone explains {part} of the differences between cells."
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
    """Say where a spectrum has its greatest line, to half a period in what was travelled or recorded."""
    meta = figure.layout.meta
    if not meta:
        return "The recording is too short for a spectrum."
    line = strongest(figure)
    if line is None:
        return "No line rises above what noise alone exceeds once in a hundred recordings."
    name, order, resolution, amplitude = line
    digits = max(0, math.ceil(-math.log10(resolution)))
    unit = unit_shown(figure, "xaxis").replace("1/turn", "per turn").replace("1/m", "per metre")
    return (
        f"The strongest line, {name}, stands at {order:.{digits}f} ± {number(resolution, 1)} {unit}, with an amplitude "
        f"of {number(amplitude)} {unit_shown(figure)}."
    )


def loop_words(figure: Figure) -> str:
    """Say how far the branches before and after reversals lie apart, as measured and as modelled."""
    found = {name: _apart(figure, name) for name in ("measured", "modelled")}
    unit = axis_unit(figure.layout.yaxis)
    text = f"Means over {(figure.layout.meta or {}).get('reversals', 'all')} reversals."
    apart = {name: value for name, value in found.items() if value is not None}
    if len(apart) < len(found):
        return f"{text} There is too little motion about them to compare before and after."
    same = apart["modelled"] < _NONE * apart["measured"]
    modelled = "not at all in the model" if same else f"by {number(apart['modelled'])} {unit} in the model"
    return (
        f"{text} At the same velocity, friction before and after a reversal differs by {number(apart['measured'])} "
        f"{unit} RMS as measured, and {modelled}."
    )


def _apart(figure: Figure, name: str) -> float | None:
    """Return the RMS distance of the branches before and after reversals, where both have values."""
    branches = {str(trace.name): trace for trace in figure.data if trace.showlegend}
    gaps = []
    for side in (-1, 1):
        pair = []
        for when in ("before", "after"):
            x, y = (
                np.asarray(values, dtype=float)
                for values in (branches[f"{name}, {when}"].x, branches[f"{name}, {when}"].y)
            )
            own = np.isfinite(x) & (np.sign(x) == side)
            order = np.argsort(x[own])
            pair.append((x[own][order], y[own][order]))
        (before, low), (after, high) = pair
        if len(before) < _BRANCH or len(after) < _BRANCH:
            continue
        at = before[(before >= after[0]) & (before <= after[-1])]
        gaps.append(np.interp(at, before, low) - np.interp(at, after, high))
    joined = np.concatenate(gaps) if gaps else np.zeros(0)
    return rms(joined) if len(joined) else None


def curve_words(figure: Figure, comparison: Comparison) -> str:
    """Say what a friction curve shows, and where measured and modelled part most."""
    meta = figure.layout.meta or {}
    text = "The cloud is what was measured, less everything in the model that is not friction; the line is the model."
    if meta.get("band beyond"):
        text += " The band of ±2 standard errors goes beyond the axis: this recording hardly determines the parameters."
    if "gap" not in meta:
        return text
    unit, speed = FORCE.unit(comparison.drive.motion), VELOCITY.unit(comparison.drive.motion)
    return (
        f"{text} On average over a velocity they part most, by {number(abs(meta['gap']))} {unit}, at "
        f"{number(meta['at'])} {speed}."
    )


def against_words(figure: Figure, effect: str) -> str:
    """Say how large the mean error over a channel is, and what is left of it with an effect."""
    meta, unit = figure.layout.meta, axis_unit(figure.layout.yaxis)
    over = axis_title(figure.layout.xaxis)
    text = f"The mean error over {over} is {number(meta['means'])} {unit} RMS"
    if meta.get("opposes"):
        text = f"Counted opposing the motion, the mean error over {over} is {number(meta['means'])} {unit} RMS"
    if "left" in meta:
        return f"{text}; with {effect} in the model, {number(meta['left'])} {unit} is left."
    return f"{text}."


def low_speed_words(figure: Figure, effect: str) -> str:
    """Say how far the means of friction and of the model lie apart over the speed, and how far with an effect."""
    meta, unit = figure.layout.meta or {}, axis_unit(figure.layout.yaxis)
    text = "Means of the friction opposing the motion, with 95 % bars, over the speed on a logarithmic axis"
    if "means" not in meta:
        return f"{text}."
    if "left" in meta:
        change = f"with {effect or 'what was found'}, {number(meta['left'])} {unit}"
        return f"{text}. Measured and modelled lie {number(meta['means'])} {unit} RMS apart; {change}."
    return f"{text}. Measured and modelled lie {number(meta['means'])} {unit} RMS apart."
