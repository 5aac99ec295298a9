"""What friction does at reversals: loops over velocity, and over the way gone since."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmodels.dimension import DISPLACEMENT
from fricmodels.errors import InputError
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, graph_objects, label, styled, subplots, unit_of, words

if TYPE_CHECKING:
    from fricmodels.diagnosis.diagnose import Comparison

Array = NDArray[np.float64]

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
        count: number of reversals.
    """

    index: NDArray[np.int64]
    leaving: NDArray[np.bool_]
    way: Array
    count: int


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
    index, leaving, way = [], [], []
    for before, after in zip(last.tolist(), first.tolist(), strict=True):
        begin = max(before - length, int(borders[np.searchsorted(borders, before) - 1]))
        end = min(after + length, int(borders[np.searchsorted(borders, after, side="right")]))
        for part, leaves, origin in (
            (np.arange(begin, before + 1), False, before),
            (np.arange(after, end), True, after),
        ):
            index.append(part)
            leaving.append(np.full(len(part), leaves))
            way.append(np.abs(travelled[part] - travelled[origin]))
    return Reversals(np.concatenate(index), np.concatenate(leaving), np.concatenate(way), len(turns))


def _travelled(samples: Samples) -> Array:
    """Return the position, or the integral of the velocity where it was not measured."""
    if "position" in samples.recording:
        return samples.recording["position"]
    velocity, time = samples.velocity, samples.place
    return np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2 * np.diff(time))])


def hysteresis(comparison: Comparison) -> Figure:
    """Draw friction torque around reversals, measured and modelled: over velocity, and over the way gone since.

    Means over all reversals. Where the branch towards a reversal and the branch away from it differ, friction has a
    memory; where the friction torque builds up over a distance, there is presliding.

    Raises:
        InputError: when the recording never reverses.
    """
    samples = Samples.of(comparison)
    near = reversals(samples)
    figure = subplots()(rows=1, cols=2, shared_yaxes=True, horizontal_spacing=0.05)
    velocity, side = samples.velocity[near.index], np.sign(samples.velocity[near.index])
    for name, torque, colour in (
        ("measured", samples.measured_friction[near.index], "measured"),
        ("modelled", samples.modelled_friction[near.index], "vermillion"),
    ):
        _loops(figure, name, velocity, torque, near.leaving, LIGHT[colour])
        _build_up(figure, name, near.way[near.leaving], (side * torque)[near.leaving], LIGHT[colour])
    displacement = label("way since reversal", unit_of(DISPLACEMENT, samples.motion))
    figure.update_xaxes(title_text=samples.axis("velocity"), row=1, col=1)
    figure.update_xaxes(title_text=displacement, row=1, col=2)
    figure.update_yaxes(title_text=samples.torque_axis("friction torque"), row=1, col=1)
    torque_name = words("friction torque", samples.motion)
    title = f"{torque_name.capitalize()} around {near.count} reversal{'s' if near.count > 1 else ''}"
    return styled(figure, title, samples.subtitle, height=440)


def _binned(x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Return the means of x and of y, and the standard error of the latter, in bins of equal numbers of samples."""
    order = np.argsort(x, kind="stable")
    count = min(_BINS, len(order) // _LEAST)
    if count < 2:
        return x[order], y[order], np.zeros(len(order))
    parts = np.array_split(order, count)
    means = np.array([[x[part].mean(), y[part].mean(), y[part].std() / np.sqrt(len(part))] for part in parts]).T
    return means[0], means[1], means[2]


def _loops(figure: Any, name: str, velocity: Array, torque: Array, leaving: NDArray[np.bool_], colour: str) -> None:
    """Add the branches that lead to reversals and those that leave them, on each side of zero."""
    dash = "solid" if name == "measured" else "4px,2px"
    for leaves, words_, symbol in ((False, "before", "circle-open"), (True, "after", "circle")):
        branches = []
        for negative in (True, False):
            part = (leaving == leaves) & ((velocity < 0) == negative)
            branches.append(_binned(velocity[part], torque[part]))
        x = np.concatenate([branches[0][0], [np.nan], branches[1][0]])
        y = np.concatenate([branches[0][1], [np.nan], branches[1][1]])
        figure.add_trace(
            graph_objects().Scatter(
                x=x,
                y=y.astype(np.float32),
                name=f"{name}, {words_}",
                mode="lines+markers",
                line={"color": colour, "width": 1.8 if leaves else 1.2, "dash": dash},
                marker={"symbol": symbol, "size": 5, "color": colour},
            ),
            row=1,
            col=1,
        )


def _build_up(figure: Any, name: str, way: Array, torque: Array, colour: str) -> None:
    """Add the friction torque, in the sense that opposes the motion, over the way since the reversal."""
    x, y, _ = _binned(way, torque)
    dash = "solid" if name == "measured" else "4px,2px"
    figure.add_trace(
        graph_objects().Scatter(
            x=x,
            y=y.astype(np.float32),
            name=f"{name}, after",
            showlegend=False,
            mode="lines+markers",
            line={"color": colour, "width": 1.8, "dash": dash},
            marker={"symbol": "circle", "size": 5, "color": colour},
        ),
        row=1,
        col=2,
    )
