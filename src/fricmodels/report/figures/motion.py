"""Simulated motion beside the measured one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array
from fricmodels.report.figures.downsample import together
from fricmodels.report.figures.style import Figure, add_lines, label, styled, subplots, unit_of
from fricmodels.report.figures.time_course import without_outliers

if TYPE_CHECKING:
    from fricmodels.motion import Judged, Replays


_EMPTY, _GAP = 0.4, 0.04
"""Share of the axis that nothing fills from which the pieces stand beside each other, and the share between them."""


def _without_gaps(time: Array, interval: float) -> tuple[Array, str]:
    """Return times without long gaps between pieces, and what the axis is; times as they are where little is empty.

    Args:
        time: not decreasing [s], shape (N,).
        interval: of sampling [s].
    """
    steps = np.diff(time)
    gaps = steps > 2 * interval
    whole, empty = float(steps.sum()), float(steps[gaps].sum())
    if not empty > _EMPTY * whole:
        return time, "time"
    steps = np.where(gaps, _GAP * (whole - empty), steps)
    return np.concatenate([[0.0], np.cumsum(steps)]), "time, gaps left out"


def _one_clock(time: Array, interval: float) -> Array:
    """Return times that do not decrease: runs with clocks of their own stand one after the other."""
    steps = np.diff(time)
    if not np.any(steps < 0):
        return time
    return np.concatenate([[0.0], np.cumsum(np.where(steps > 0, steps, interval))])


def simulated_velocity(replays: Replays) -> Figure:
    """Draw the velocity as measured and as models simulate it from the measured torque, and the errors below it.

    A line is interrupted where the simulation begins anew from the measured state.

    Args:
        replays: the first model is the one before, where there are two.
    """
    recording, last = replays.stretch.recording, replays.models[-1]
    before = replays.models[0] if len(replays.models) > 1 else None
    time, axis = _without_gaps(_one_clock(recording.time, recording.interval), recording.interval)
    unit, measured = unit_of("velocity", recording.motion), recording.velocity
    errors = [each.velocity - measured for each in ([last] if before is None else [last, before])]
    thin = together(time, [measured, *errors], replays.stretch.place)
    figure = subplots()(rows=2, cols=1, shared_xaxes=True, row_heights=[0.66, 0.34], vertical_spacing=0.06)
    drawn = [
        (1, "velocity measured", thin.values[0], "measured", "solid", 1.8),
        (1, "velocity simulated", thin.values[0] + thin.values[1], "vermillion", "4px,2px", 1.4),
        (2, "simulated − measured", thin.values[1], "blue", "solid", 1.2),
    ]
    if before is not None:
        drawn.insert(1, (1, "simulated, model as given", thin.values[0] + thin.values[2], "faint", "solid", 1.2))
        drawn.insert(3, (2, "error, model as given", thin.values[2], "faint", "solid", 1.0))
    add_lines(figure, thin.x, drawn, unit)
    beyond = np.zeros(len(time), dtype=bool)
    simulated = [measured + error for error in errors]
    for row, limits, values in (
        (1, without_outliers([measured], simulated), simulated),
        (2, without_outliers([], errors), errors),
    ):
        if limits is not None:
            figure.update_yaxes(range=limits, row=row, col=1)
            beyond |= np.logical_or.reduce([(each < limits[0]) | (each > limits[1]) for each in values])
    meta = {"drawn": thin.drawn, "total": len(time), "beyond": int(np.count_nonzero(beyond))}
    figure.update_layout(meta=meta, hovermode="x unified")
    figure.update_yaxes(title_text=label("velocity", unit), row=1, col=1)
    figure.update_yaxes(title_text=label("error", unit), row=2, col=1)
    figure.update_xaxes(title_text=label(axis, "s"), row=2, col=1)
    return styled(figure, "Velocity over time, measured and simulated", last.model, height=330)


def simulated_motion(judged: Judged) -> Figure:
    """Draw the position as measured and as simulated on what was kept back, and the error below it.

    Args:
        judged: a model, with the parameters that were fitted to the motion, or those of the torque where there are
            none.
    """
    simulator = judged.kept
    recording = simulator.recording
    values = judged.rung.parameters if judged.fit is None else judged.fit.parameters
    position, velocity = simulator(values)
    known = "position" in recording
    channel = "position" if known else "velocity"
    simulated, measured = (position, recording["position"]) if known else (velocity, recording.velocity)
    time, axis = _without_gaps(_one_clock(recording.time, recording.interval), recording.interval)
    unit = unit_of(channel, recording.motion)
    error = np.nan_to_num(simulated - measured)
    thin = together(time, [measured, error], recording.run)
    figure = subplots()(rows=2, cols=1, shared_xaxes=True, row_heights=[0.66, 0.34], vertical_spacing=0.06)
    drawn = [
        (1, f"{channel} measured", thin.values[0], "measured", "solid", 1.8),
        (1, f"{channel} simulated", thin.values[0] + thin.values[1], "vermillion", "4px,2px", 1.4),
        (2, "simulated − measured", thin.values[1], "blue", "solid", 1.2),
    ]
    add_lines(figure, thin.x, drawn, unit)
    figure.update_layout(meta={"drawn": thin.drawn, "total": len(time)}, hovermode="x unified")
    figure.update_yaxes(title_text=label(channel, unit), row=1, col=1)
    figure.update_yaxes(title_text=label("error", unit), row=2, col=1)
    figure.update_xaxes(title_text=label(axis, "s"), row=2, col=1)
    return styled(figure, f"{channel.capitalize()} over time, measured and simulated", judged.rung.name, height=400)
