"""Torque and its parts over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import RUN
from fricmodels.report.figures.downsample import together
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import (
    LIGHT,
    POINTS,
    Figure,
    add_lines,
    graph_objects,
    stroke,
    styled,
    subplots,
    words,
)

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison

_PIXEL = 1 / 500
"""Share of the axis by which two shaded spans must be apart to be shown apart."""


_OUTER = 0.004
"""Share of samples that may lie beyond the axis, so that a few outliers do not flatten all the rest."""
_ROOM, _FAR = 0.15, 1.6
"""Room about the curves as a share of their span, and times the axis that outliers must need to be left out of it."""
_MOST_BORDERS = 60
"""More borders of runs than this would hide the curves."""


def worst_stretch(comparison: Comparison) -> tuple[float, float]:
    """Return from when to when [s] so many samples are that hold the largest squared error."""
    samples = Samples.of(comparison)
    count = min(POINTS, len(samples.place))
    total = np.concatenate([[0.0], np.cumsum(np.nan_to_num(samples.error) ** 2)])
    first = int(np.argmax(total[count:] - total[:-count]))
    return float(samples.place[first]), float(samples.place[first + count - 1])


def beyond_axes(figure: Figure) -> int:
    """Return how many samples of an :func:`overlay` lie beyond its axes."""
    return int(figure.layout.meta["beyond"])


def drawn_samples(figure: Figure) -> tuple[int, int]:
    """Return how many samples an :func:`overlay` draws, and of how many."""
    return int(figure.layout.meta["drawn"]), int(figure.layout.meta["total"])


def overlay(
    comparison: Comparison, between: tuple[float, float] | None = None, before: Comparison | None = None
) -> Figure:
    """Draw the torque as measured and as modelled over time, and the residual below it.

    What was kept back from the fit is shaded. The dotted lines about zero are two standard deviations of what the
    noise of the sensors alone would leave.

    Args:
        comparison: a model and a recording.
        between: first and last time [s] to show; everything if not given.
        before: a smaller model of the same recording, whose residual is drawn behind, on the same axis.
    """
    samples = Samples.of(comparison)
    torque = words("torque", samples.motion)
    figure = stacked()
    chosen = slice(None)
    if between is not None:
        chosen = slice(*np.searchsorted(samples.place, between).tolist())
    place, piece = samples.place[chosen], samples.recording.run[chosen]
    measured, error = samples.recording.torque[chosen], samples.error[chosen]
    signals = [measured, error] + ([] if before is None else [Samples.of(before).error[chosen]])
    thin = together(place, signals, piece)
    whole = thin.drawn == len(place)
    drawn = [
        (1, f"{torque} measured", thin.values[0], "measured", "solid", 1.6 if whole else 2.2),
        (1, f"{torque} modelled", thin.values[0] - thin.values[1], "vermillion", "4px,2px", 1.4 if whole else 0.8),
        (2, "residual", thin.values[1], "blue", "solid", 1.0),
    ]
    if before is not None:
        drawn.insert(2, (2, "residual of the model as given", thin.values[2], "faint", "solid", 1.0))
    add_lines(figure, thin.x, drawn, samples.torque_unit)
    model, rest = measured - error, [error] if before is None else [error, Samples.of(before).error[chosen]]
    top, low = without_outliers([measured], [model]), without_outliers([], rest)
    beyond = limit(figure, ((top, [measured, model]), (low, rest)))
    figure.update_layout(meta={"drawn": thin.drawn, "total": len(place), "beyond": beyond})
    _shade(figure, samples, between)
    _borders(figure, place, samples.recording.signal(RUN)[chosen])
    noise = 2 * comparison.errors.headline.fit_noise_percent / 100 * comparison.train.rms_torque
    for i, level in enumerate((noise, -noise)):
        ends, once = place[[0, -1]], {"legendgroup": "noise", "showlegend": i == 0}
        name = "sensor noise alone (±2σ)"
        trace = stroke(ends, [level, level], name, "muted", 1.2, "dot", hoverinfo="skip", **once)
        figure.add_trace(trace, row=2, col=1)
    figure.update_yaxes(title_text=samples.torque_axis("torque"), row=1, col=1)
    figure.update_yaxes(title_text=samples.torque_axis("residual"), row=2, col=1)
    figure.update_xaxes(title_text=samples.time_axis, row=2, col=1)
    figure.update_layout(hovermode="x unified")
    return styled(figure, f"{torque.capitalize()} over time, measured and modelled", samples.subtitle, height=400)


def stacked() -> Figure:
    """Return an empty figure of curves over time, with their errors below."""
    return subplots()(rows=2, cols=1, shared_xaxes=True, row_heights=[0.66, 0.34], vertical_spacing=0.06)


def limit(figure: Figure, rows: Sequence[tuple[list[float] | None, Sequence[Array]]]) -> int:
    """Set the axes of the rows of a figure that have limits; return how many samples of their curves lie beyond."""
    beyond = np.zeros(len(rows[0][1][0]), dtype=bool)
    for row, (limits, curves) in enumerate(rows, start=1):
        if limits is not None:
            figure.update_yaxes(range=limits, row=row, col=1)
            beyond |= np.logical_or.reduce([(each < limits[0]) | (each > limits[1]) for each in curves])
    return int(np.count_nonzero(beyond))


def without_outliers(whole: list[Array], curves: list[Array]) -> list[float] | None:
    """Return an axis that leaves out a few values far off, which would flatten all the rest; ``None`` for all of them.

    Args:
        whole: curves that are shown entirely.
        curves: curves of which the outermost samples may lie beyond the axis.
    """
    joined = [each[np.isfinite(each)] for each in curves]
    if not all(len(each) for each in joined):
        return None
    ends = [np.quantile(each, [_OUTER / 2, 1 - _OUTER / 2]) for each in joined]
    ends += [np.array([each.min(), each.max()]) for each in whole]
    low, high = min(float(each[0]) for each in ends), max(float(each[1]) for each in ends)
    margin = _ROOM * (high - low)
    needed = max(float(each.max()) for each in joined) - min(float(each.min()) for each in joined)
    return [low - margin, high + margin] if needed > _FAR * (high - low + 2 * margin) else None


def _borders(figure: Figure, place: Array, run: Array) -> None:
    """Mark where one run ends and the next begins, and say so in the legend."""
    borders = np.flatnonzero(np.diff(run))
    if not 0 < len(borders) <= _MOST_BORDERS:
        return
    line = {"color": LIGHT["muted"], "width": 1, "dash": "dash"}
    for border in borders.tolist():
        for axis in ("y domain", "y2 domain"):
            x = float(place[border] + place[border + 1]) / 2
            figure.add_shape(type="line", x0=x, x1=x, y0=0, y1=1, xref="x", yref=axis, line=line)
    figure.add_trace(
        graph_objects().Scatter(x=[None], y=[None], name="border of runs", mode="lines", line=line), row=1, col=1
    )


def _shade(figure: Figure, samples: Samples, between: tuple[float, float] | None) -> None:
    """Shade what was kept back, and say so in the legend."""
    go = graph_objects()
    edges = np.flatnonzero(np.diff(np.concatenate([[0], samples.kept_back.astype(np.int8), [0]])))
    spans = [(float(samples.place[a]), float(samples.place[b - 1])) for a, b in edges.reshape(-1, 2)]
    if between is not None:
        spans = [(max(a, between[0]), min(b, between[1])) for a, b in spans if a < between[1] and b > between[0]]
    for a, b in _merged(spans, _PIXEL * float(np.ptp(samples.place))):
        for reference in ("y domain", "y2 domain"):
            figure.add_shape(
                type="rect", x0=a, x1=b, y0=0, y1=1, xref="x", yref=reference, layer="below",
                fillcolor=LIGHT["shade"], line_width=0,
            )  # fmt: skip
    if spans:
        figure.add_trace(
            go.Scatter(
                x=[None],
                y=[None],
                name="test data, not fitted",
                mode="markers",
                marker={"symbol": "square", "size": 14, "color": LIGHT["shade"], "line_width": 0},
            ),
            row=1,
            col=1,
        )


def _merged(spans: list[tuple[float, float]], apart: float) -> list[tuple[float, float]]:
    """Join spans that are closer to each other than can be seen."""
    joined: list[tuple[float, float]] = []
    for a, b in spans:
        if joined and a - joined[-1][1] < apart:
            joined[-1] = (joined[-1][0], b)
        else:
            joined.append((a, b))
    return joined
