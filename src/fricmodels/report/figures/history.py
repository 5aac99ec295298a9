"""How the parameters of a sequential estimator develop."""

from __future__ import annotations

from collections.abc import Sequence
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
    stroke,
    styled,
    subplots,
    unit_text,
)
from fricmodels.results.history import Course, ParameterHistory
from fricmodels.results.words import NORMAL_95

if TYPE_CHECKING:
    from fricmodels.fit import Fit


_POINTS = 6000
"""Points of all lines together."""
_WIDEST = 1.5
"""Half a band that an axis holds, in sizes of the estimates."""


def parameter_history(fit: Fit | ParameterHistory) -> Figure:
    """Draw each parameter over time while it is being estimated, with the filter's own two standard deviations.

    At the end stands the value of the fit with its 95 % interval. The axes leave out how far the first moments go
    astray; a double click on a panel shows all.

    Args:
        fit: of a sequential estimator, or its history.

    Raises:
        InputError: when the fit has no history.
    """
    data = fit if isinstance(fit, ParameterHistory) else _whole(fit)
    time = _array(data.time)
    restart = np.concatenate([[0], np.cumsum(np.diff(time) <= 0)]).astype(np.int64)
    place = time if restart[-1] == 0 else np.arange(len(time), dtype=float)
    courses = data.courses
    figure = subplots()(rows=len(courses), cols=1, shared_xaxes=True, vertical_spacing=0.25 / max(4, len(courses)))
    points = min(POINTS, max(120, _POINTS // (4 * len(courses))))
    drawn = 0
    for row, (key, course) in enumerate(courses.items(), start=1):
        values = _array(course.estimates)
        spread = None if course.deviations is None else 2 * _array(course.deviations)
        lines = [("estimate", values, "blue", "solid", 1.8)]
        if spread is not None:
            lines += [("±2 standard deviations", values + side * spread, "blue", "dot", 1.0) for side in (1, -1)]
        if course.truth is not None:
            lines.append(("true", np.full(len(values), course.truth), "vermillion", "dash", 1.6))
        for i, (name, each, colour, dash, width) in enumerate(lines):
            thin = line(place, each, restart, points)
            drawn = max(drawn, len(thin.x)) if name == "estimate" else drawn
            shown = f"{name}: %{{y:.5g}}<br>at %{{x:.4g}}<extra></extra>"
            once = {"legendgroup": name, "showlegend": row == 1 and i != 2}
            trace = stroke(thin.x, thin.y, name, colour, width, dash, hovertemplate=shown, **once)
            figure.add_trace(trace, row=row, col=1)
        if course.final is not None:
            figure.add_trace(_end(course, float(place[-1]), first=row == 1), row=row, col=1)
        title = label(escaped(key).replace(".", "<br>"), unit_text(course.unit))
        figure.update_yaxes(title_text=title, range=_settled(values, spread, _known(course)), row=row, col=1)
    figure.update_xaxes(title_text="time [s]" if restart[-1] == 0 else "sample [1]", row=len(courses), col=1)
    figure.update_layout(meta={"drawn": min(drawn, data.kept), "total": data.kept})
    title = "Parameters while they are being estimated"
    return styled(figure, title, f"{data.dataset}: {data.model}, {data.estimator}", height=140 + 120 * len(courses))


def _whole(fit: Fit) -> ParameterHistory:
    """Return all that a fit kept of its history."""
    from fricmodels.drive import Drive
    from fricmodels.model import Model

    if fit.history is None:
        raise InputError(f"'{fit.estimator}' keeps no history; fit with a sequential estimator such as 'ekf' or 'rls'")
    motion = Motion.LINEAR if "M" in fit.parameters else Motion.ROTARY
    units = Drive(Model.parse(fit.model), None, motion).units
    found = fit.parameter_history(units, None, points=4 * len(fit.history))
    if found is None:
        raise InputError(f"the fit of '{fit.model}' by '{fit.estimator}' kept no estimate; its history is empty")
    return found


def _end(course: Course, place: float, *, first: bool) -> Figure:
    """Return the value of the fit, with its 95 % interval where it has one."""
    half = None if course.standard_error is None else [NORMAL_95 * course.standard_error]
    name = "fit, 95 % interval"
    return graph_objects().Scatter(
        x=[place],
        y=[course.final],
        name=name,
        legendgroup=name,
        showlegend=first,
        mode="markers",
        marker={"color": LIGHT["text"], "symbol": "diamond", "size": 8},
        error_y=None if half is None else {"type": "data", "array": half, "color": LIGHT["text"], "thickness": 1.4},
        hovertemplate="fit: %{y:.5g}<extra></extra>",
        cliponaxis=False,
    )


def _array(values: Sequence[float | None]) -> Array:
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _known(course: Course) -> list[float]:
    """Return the values that a panel shows whole: the truth, and what the fit gives."""
    return [value for value in (course.truth, course.final) if value is not None]


def _settled(values: Array, spread: Array | None, known: Sequence[float]) -> list[float] | None:
    """Return a range that holds nine tenths of the estimates, and all of the last half with its uncertainty.

    A band much wider than the estimates are large leaves the axis: it would leave nothing else to see.
    """
    last = slice(len(values) // 2, None)
    around = 0.0 if spread is None else np.minimum(spread[last], _WIDEST * np.nanmax(np.abs([*values[last], *known])))
    held = np.concatenate([np.quantile(values, [0.05, 0.95]), values[last] - around, values[last] + around, known])
    low, high = float(np.min(held)), float(np.max(held))
    margin = 0.08 * (high - low)
    return [low - margin, high + margin] if margin > 0 and np.isfinite(margin) else None
