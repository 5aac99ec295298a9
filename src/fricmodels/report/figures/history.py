"""How the parameters of a sequential estimator develop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.report.figures.downsample import line
from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, label, styled, subplots, unit_text

if TYPE_CHECKING:
    from fricmodels.drive import Drive
    from fricmodels.fit import Fit


def parameter_history(fit: Fit, drive: Drive | None = None) -> Figure:
    """Draw each parameter over time while it is being estimated, with the filter's own two standard deviations.

    Args:
        fit: of a sequential estimator.
        drive: that was fitted; found by the model's name if not given.

    Raises:
        InputError: when the fit has no history.
    """
    from fricmodels.drive import Drive
    from fricmodels.model import Model

    go = graph_objects()
    if fit.history is None:
        raise InputError(f"'{fit.estimator}' keeps no history; fit with a sequential estimator such as 'ekf' or 'rls'")
    motion = Motion.LINEAR if "M" in fit.parameters else Motion.ROTARY
    drive = drive or Drive(Model.parse(fit.model), None, motion)
    units = {p.key: unit_text(p.declared.unit_for(drive.motion)) for p in drive.parameters}
    keys = [key for key in fit.estimated if key in fit.history]
    time = fit.history["time"].to_numpy(dtype=float)
    restart = np.concatenate([[0], np.cumsum(np.diff(time) <= 0)]).astype(np.int64)
    place = time if restart[-1] == 0 else np.arange(len(time), dtype=float)
    figure = subplots()(rows=len(keys), cols=1, shared_xaxes=True, vertical_spacing=0.25 / max(4, len(keys)))
    for row, key in enumerate(keys, start=1):
        values = fit.history[key].to_numpy(dtype=float)
        lines = [("estimate", values, "blue", "solid", 1.6)]
        if f"sd({key})" in fit.history:
            spread = 2 * fit.history[f"sd({key})"].to_numpy(dtype=float)
            lines += [("±2 standard deviations", values + side * spread, "blue", "dot", 0.9) for side in (1, -1)]
        for i, (name, each, colour, dash, width) in enumerate(lines):
            thin = line(place, each, restart, 1000)
            figure.add_trace(
                go.Scatter(
                    x=thin.x,
                    y=thin.y,
                    name=name,
                    legendgroup=name,
                    showlegend=row == 1 and i < 2,
                    mode="lines",
                    line={"color": LIGHT[colour], "width": width, "dash": dash},
                ),
                row=row,
                col=1,
            )
        figure.update_yaxes(title_text=label(escaped(key), units.get(key, "1")), row=row, col=1)
    figure.update_xaxes(title_text="time [s]" if restart[-1] == 0 else "sample [1]", row=len(keys), col=1)
    title = "Parameters while they are being estimated"
    return styled(figure, title, f"{fit.estimator}: {fit.model}, {fit.dataset}", height=120 + 130 * len(keys))
