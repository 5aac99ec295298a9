"""Simulated motion beside the measured one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.report.figures.downsample import Together, together
from fricmodels.report.figures.style import Figure, add_lines, label, styled, unit_of
from fricmodels.report.figures.time_course import limit, stacked, without_outliers

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
    figure = stacked()
    drawn = _curves("velocity", thin)
    if before is not None:
        drawn.insert(1, (1, "simulated, model as given", thin.values[0] + thin.values[2], "faint", "solid", 1.2))
        drawn.insert(3, (2, "error, model as given", thin.values[2], "faint", "solid", 1.0))
    add_lines(figure, thin.x, drawn, unit)
    simulated = [measured + error for error in errors]
    top, low = without_outliers([measured], simulated), without_outliers([], errors)
    beyond = limit(figure, ((top, simulated), (low, errors)))
    _lay_out(figure, "velocity", unit, axis, {"drawn": thin.drawn, "total": len(time), "beyond": beyond})
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
    known = recording.measures("position")
    channel = "position" if known else "velocity"
    simulated, measured = (position, recording["position"]) if known else (velocity, recording.velocity)
    time, axis = _without_gaps(_one_clock(recording.time, recording.interval), recording.interval)
    unit = unit_of(channel, recording.motion)
    error = np.nan_to_num(simulated - measured)
    thin = together(time, [measured, error], recording.run)
    figure = stacked()
    add_lines(figure, thin.x, _curves(channel, thin), unit)
    _lay_out(figure, channel, unit, axis, {"drawn": thin.drawn, "total": len(time)})
    return styled(figure, f"{channel.capitalize()} over time, measured and simulated", judged.rung.name, height=400)


def _curves(channel: str, thin: Together) -> list[tuple[int, str, Any, str, str, float]]:
    """Return the curves of a channel as measured and as simulated, and of the error between them."""
    return [
        (1, f"{channel} measured", thin.values[0], "measured", "solid", 1.8),
        (1, f"{channel} simulated", thin.values[0] + thin.values[1], "vermillion", "4px,2px", 1.4),
        (2, "simulated − measured", thin.values[1], "blue", "solid", 1.2),
    ]


def _lay_out(figure: Figure, channel: str, unit: str, axis: str, meta: dict[str, int]) -> None:
    figure.update_layout(meta=meta, hovermode="x unified")
    figure.update_yaxes(title_text=label(channel, unit), row=1, col=1)
    figure.update_yaxes(title_text=label("error", unit), row=2, col=1)
    figure.update_xaxes(title_text=label(axis, "s"), row=2, col=1)
