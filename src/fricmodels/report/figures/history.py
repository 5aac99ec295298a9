"""How the parameters of a sequential estimator develop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.report.figures.downsample import line
from fricmodels.report.figures.style import (
    LIGHT,
    POINTS,
    Figure,
    escaped,
    graph_objects,
    label,
    styled,
    subplots,
    unit_text,
)

if TYPE_CHECKING:
    from fricmodels.drive import Drive
    from fricmodels.fit import Fit


_POINTS = 6000
"""Points of all lines together."""


def parameter_history(fit: Fit, drive: Drive | None = None, true: Mapping[str, float] | None = None) -> Figure:
    """Draw each parameter over time while it is being estimated, with the filter's own two standard deviations.

    The axes leave out how far the first moments go astray; a double click on a panel shows all.

    Args:
        fit: of a sequential estimator.
        drive: that was fitted; found by the model's name if not given.
        true: values by key, where they are known.

    Raises:
        InputError: when the fit has no history.
    """
    from fricmodels.drive import Drive
    from fricmodels.model import Model

    history = fit.history
    if history is None:
        raise InputError(f"'{fit.estimator}' keeps no history; fit with a sequential estimator such as 'ekf' or 'rls'")
    motion = Motion.LINEAR if "M" in fit.parameters else Motion.ROTARY
    drive = drive or Drive(Model.parse(fit.model), None, motion)
    units = {p.key: unit_text(p.declared.unit_for(drive.motion)) for p in drive.parameters}
    keys = [key for key in fit.estimated if key in history]
    time = history["time"].to_numpy(dtype=float)
    restart = np.concatenate([[0], np.cumsum(np.diff(time) <= 0)]).astype(np.int64)
    place = time if restart[-1] == 0 else np.arange(len(time), dtype=float)
    figure = subplots()(rows=len(keys), cols=1, shared_xaxes=True, vertical_spacing=0.25 / max(4, len(keys)))
    for row, key in enumerate(keys, start=1):
        values = history[key].to_numpy(dtype=float)
        spread = 2 * history[f"sd({key})"].to_numpy(dtype=float) if f"sd({key})" in history else None
        lines = [("estimate", values, "blue", "solid", 1.8)]
        if spread is not None:
            lines += [("±2 standard deviations", values + side * spread, "blue", "dot", 1.0) for side in (1, -1)]
        known = [] if true is None or key not in true else [true[key]]
        lines += [("true", np.full(len(values), value), "vermillion", "dash", 1.6) for value in known]
        for i, (name, each, colour, dash, width) in enumerate(lines):
            thin = line(place, each, restart, min(POINTS, max(120, _POINTS // (4 * len(keys)))))
            figure.add_trace(
                graph_objects().Scatter(
                    x=thin.x,
                    y=thin.y,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1 and i != 2,
                    mode="lines",
                    line={"color": LIGHT[colour], "width": width, "dash": dash},
                    hovertemplate=f"{name}: %{{y:.5g}}<br>at %{{x:.4g}}<extra></extra>",
                ),
                row=row,
                col=1,
            )
        title = label(escaped(key).replace(".", "<br>"), units.get(key, "1"))
        figure.update_yaxes(title_text=title, range=_settled(values, spread, known), row=row, col=1)
    figure.update_xaxes(title_text="time [s]" if restart[-1] == 0 else "sample [1]", row=len(keys), col=1)
    title = "Parameters while they are being estimated"
    return styled(figure, title, f"{fit.dataset}: {fit.model}, {fit.estimator}", height=140 + 120 * len(keys))


def _settled(values: Array, spread: Array | None, known: Sequence[float]) -> list[float] | None:
    """Return a range that holds nine tenths of the estimates, and all of the last half with its uncertainty."""
    last = slice(len(values) // 2, None)
    around = 0.0 if spread is None else spread[last]
    held = np.concatenate([np.quantile(values, [0.05, 0.95]), values[last] - around, values[last] + around, known])
    low, high = float(np.min(held)), float(np.max(held))
    margin = 0.08 * (high - low)
    return [low - margin, high + margin] if margin > 0 and np.isfinite(margin) else None
