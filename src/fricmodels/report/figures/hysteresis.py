"""What friction does at reversals: loops over velocity, and over the way gone since."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.dimension import DISPLACEMENT
from fricmodels.errors import InputError
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, graph_objects, label, styled, subplots, unit_of, words
from fricmodels.signals.integrated import way

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison


_BINS = 24
_LEAST = 5
"""Samples from which a mean is shown."""


@dataclass(frozen=True)
class Reversals:
    """Samples near reversals of a comparison.

    Attributes:
        index: of the samples.
        leaving: whether a sample follows its reversal, or leads to it.
        way: displacement since the reversal, or until it [rad or m], not negative.
        turn: number of the reversal that a sample belongs to, from 0.
    """

    index: Index
    leaving: Mask
    way: Array
    turn: Index

    @property
    def count(self) -> int:
        """Number of reversals."""
        return int(self.turn[-1]) + 1 if len(self.turn) else 0

    def common(self, values: Array) -> Mask:
        """Mark samples whose size is within what half of all reversals reach, so that a mean is not of a few only."""
        if not len(values):
            return np.zeros(0, dtype=np.bool_)
        size, reached = np.abs(values), np.zeros(self.count)
        np.maximum.at(reached, self.turn, size)
        return np.asarray(size <= np.median(reached[np.unique(self.turn)]))

    def select(self, mask: Mask) -> Reversals:
        """Return some of the samples."""
        return Reversals(self.index[mask], self.leaving[mask], self.way[mask], self.turn[mask])


def reversals(samples: Samples) -> Reversals:
    """Find the samples within a quarter of the usual time between reversals before and after each of them.

    Raises:
        InputError: when the recording never reverses.
    """
    moving = np.flatnonzero(~samples.resting & (samples.velocity != 0))
    side, piece = np.sign(samples.velocity[moving]), samples.recording.run[moving]
    turns = np.flatnonzero((np.diff(side) != 0) & (np.diff(piece) == 0))
    if not len(turns):
        raise InputError(f"recording '{samples.recording.name}' never reverses; there are no loops to show")
    last, first = moving[turns], moving[turns + 1]
    borders = np.concatenate([[0], moving[np.flatnonzero(np.diff(piece)) + 1], last, first, [len(samples.velocity)]])
    borders = np.unique(borders)
    length = int(max(_LEAST, np.median(np.diff(first)) / 4 if len(first) > 1 else len(moving) / 4))
    travelled = _travelled(samples)
    index, leaving, way, turn = [], [], [], []
    for number, (before, after) in enumerate(zip(last.tolist(), first.tolist(), strict=True)):
        begin = max(before - length, int(borders[np.searchsorted(borders, before) - 1]))
        end = min(after + length, int(borders[np.searchsorted(borders, after, side="right")]))
        for part, leaves, origin in (
            (np.arange(begin, before + 1), False, before),
            (np.arange(after, end), True, after),
        ):
            index.append(part)
            leaving.append(np.full(len(part), leaves))
            way.append(np.abs(travelled[part] - travelled[origin]))
            turn.append(np.full(len(part), number))
    found = Reversals(np.concatenate(index), np.concatenate(leaving), np.concatenate(way), np.concatenate(turn))
    return found.select(~samples.resting[found.index] & (samples.velocity[found.index] != 0))


def _travelled(samples: Samples) -> Array:
    """Return the position, or the integral of the velocity where it was not measured."""
    if "position" in samples.recording:
        return samples.recording["position"]
    return way(samples.place, samples.velocity)


def hysteresis(comparison: Comparison) -> Figure:
    """Draw friction torque around reversals, measured and modelled: over velocity, and over the way gone since.

    Means over all reversals. Where the branch towards a reversal and the branch away from it differ, friction has a
    memory; where the friction torque builds up over a distance, there is presliding.

    Raises:
        InputError: when the recording never reverses.
    """
    samples = Samples.of(comparison)
    near = reversals(samples)
    figure = subplots()(rows=1, cols=2, horizontal_spacing=0.12)
    for name, colour in (("measured", "measured"), ("modelled", "vermillion")):
        torque = samples.measured_friction if name == "measured" else samples.modelled_friction
        dash = "solid" if name == "measured" else "4px,2px"
        for leaves, when in ((False, "before"), (True, "after")):
            x, y = _branch(samples, near.select(near.leaving == leaves), torque)
            width = 1.8 if leaves else 1.2
            style = {"color": LIGHT[colour], "width": width, "dash": dash}
            _add(figure, 1, x, y, f"{name}, {when}", style, "circle" if leaves else "circle-open", samples.torque_unit)
        after = near.select(near.leaving)
        after = after.select(after.common(after.way))
        opposing = np.sign(samples.velocity[after.index]) * torque[after.index]
        style = {"color": LIGHT[colour], "width": 1.8, "dash": dash}
        _add(figure, 2, *_binned(after.way, opposing), f"{name}, after", style, "circle", samples.torque_unit)
        del torque
    torque_name = words("friction torque", samples.motion)
    figure.update_xaxes(title_text=samples.axis("velocity"), nticks=6, row=1, col=1)
    figure.update_yaxes(title_text=samples.torque_axis("friction torque"), row=1, col=1)
    figure.update_xaxes(
        title_text=label("distance since reversal", unit_of(DISPLACEMENT, samples.motion)),
        rangemode="tozero",
        nticks=6,
        row=1,
        col=2,
    )
    figure.update_yaxes(title_text=samples.torque_axis("opposing motion"), row=1, col=2)
    figure.update_layout(meta={"reversals": near.count, "stack": True})
    title = f"{torque_name.capitalize()} around {near.count} reversal{'s' if near.count > 1 else ''}"
    return styled(figure, title, samples.subtitle, height=380)


def _branch(samples: Samples, near: Reversals, torque: Array) -> tuple[Array, Array]:
    """Return the mean friction torque over velocity on both sides of zero, with a gap between them."""
    parts = []
    for side in (-1, 1):
        own = near.select(np.sign(samples.velocity[near.index]) == side)
        own = own.select(own.common(samples.velocity[own.index]))
        parts.append(_binned(samples.velocity[own.index], torque[own.index]))
    (left, low), (right, high) = parts
    return np.concatenate([left, [np.nan], right]), np.concatenate([low, [np.nan], high])


def _binned(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the means of x and of y in bins of as many samples each."""
    order = np.argsort(x, kind="stable")
    parts = np.array_split(order, max(1, min(_BINS, len(order) // _LEAST))) if len(order) else []
    return np.array([x[part].mean() for part in parts]), np.array([y[part].mean() for part in parts])


def _add(
    figure: Figure, column: int, x: Array, y: Array, name: str, style: Mapping[str, Any], symbol: str, unit: str
) -> None:
    figure.add_trace(
        graph_objects().Scatter(
            x=x,
            y=y.astype(np.float32),
            name=name,
            showlegend=column == 1,
            hovertemplate=f"{name}: %{{y:.4g}} {unit}<extra></extra>",
            mode="lines+markers",
            line=style,
            marker={"symbol": symbol, "size": 5, "color": style["color"]},
        ),
        row=1,
        col=column,
    )
