"""What was recorded, and what that determines: coverage of position and velocity, correlation of parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.report.figures.grid import even_edges
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, styled, words

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison

CELLS = 40
_NUMBERED = 12
"""Parameters up to which there is room for a number in each cell of their correlations."""


def coverage(comparison: Comparison) -> Figure:
    """Draw how long the drive was at each position and velocity; without a position at each acceleration.

    A model is known where there are samples; elsewhere it is extrapolated.
    """
    samples = Samples.of(comparison)
    recording = samples.recording
    moves = "position" in recording and float(np.ptp(recording["position"])) > 0
    other = "position" if moves else "acceleration"
    x, y = recording[other], samples.velocity
    edges = [even_edges(float(each.min()), float(each.max()), CELLS) for each in (x, y)]
    count = np.histogram2d(x, y, bins=edges)[0].T
    seconds = count * samples.comparison.train.interval
    shown = np.full(count.shape, np.nan, dtype=np.float32)
    shown[count > 0] = np.log10(seconds[count > 0])
    middles = [(edge[:-1] + edge[1:]) / 2 for edge in edges]
    figure = graph_objects().Figure(
        graph_objects().Heatmap(
            x=middles[0],
            y=middles[1],
            z=shown,
            customdata=seconds.astype(np.float32),
            colorscale=[[0, LIGHT["few"]], [0.5, LIGHT["some"]], [1, LIGHT["many"]]],
            showscale=False,
            hoverongaps=False,
            hovertemplate=(
                f"%{{customdata:.3g}} s<br>{words(other, samples.motion)} %{{x:.3g}} {samples.unit(other)}<br>"
                f"velocity %{{y:.3g}} {samples.unit('velocity')}<extra></extra>"
            ),
        )
    )
    meta = {
        "visited": float(np.mean(count > 0)),
        "other": words(other, samples.motion),
        "cells": "Mean time in a cell [s]",
    }
    figure.update_layout(meta=meta)
    figure.update_xaxes(title_text=samples.axis(other))
    figure.update_yaxes(title_text=samples.axis("velocity"))
    return styled(figure, f"Coverage of velocity and {words(other, samples.motion)}", samples.subtitle, height=380)


def correlation(names: Sequence[str], matrix: Sequence[Sequence[float | None]]) -> Figure:
    """Draw the correlation of the estimates of parameters: near ±1, the recording tells only a combination of two.

    Args:
        names: keys of the parameters.
        matrix: correlation of each with each.
    """
    values = np.asarray(matrix, dtype=float)
    shown = [escaped(name) for name in names]
    below = np.where(np.tri(len(shown), k=-1, dtype=bool), values, np.nan)
    figure = graph_objects().Figure(
        graph_objects().Heatmap(
            x=shown[:-1],
            y=shown[1:],
            z=below[1:, :-1].astype(np.float32),
            text=[["" if np.isnan(each) else f"{each:.2f}" for each in row] for row in below[1:, :-1]],
            texttemplate="%{text}" if len(shown) <= _NUMBERED else "",
            textfont={"size": 11, "color": LIGHT["text"]},
            zmin=-1.6,
            zmax=1.6,
            colorscale=[[0, LIGHT["below"]], [0.5, LIGHT["none"]], [1, LIGHT["above"]]],
            showscale=False,
            xgap=1,
            ygap=1,
            hoverongaps=False,
            hovertemplate="%{y} and %{x}: %{z:.3f}<extra></extra>",
        )
    )
    figure.update_xaxes(title_text="", showgrid=False, tickangle=-45)
    figure.update_yaxes(title_text="", showgrid=False, autorange="reversed")
    figure.update_layout(meta={"rows": len(shown)})
    return styled(figure, "Correlation of the parameters", "", height=160 + 26 * len(shown))


def strongest(names: Sequence[str], matrix: Sequence[Sequence[float | None]]) -> tuple[str, str, float]:
    """Return the two parameters that are correlated most, and how much."""
    values = np.abs(np.tril(np.asarray(matrix, dtype=float), -1))
    row, column = divmod(int(np.argmax(values)), len(names))
    return names[row], names[column], float(np.asarray(matrix, dtype=float)[row, column])
