"""The ladder: how the error falls with each effect that is added."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, logarithmic, styled, words

if TYPE_CHECKING:
    from fricmodels.diagnosis.ladder import Ladder, Rung

_LEAST_SHOWN = 1e-4
"""Share of the largest error below which noise is not drawn: it would take the axis with it."""


def ladder(ladder: Ladder) -> Figure:
    """Draw the torque error after each step, on what was fitted and on what was kept back, and the noise floor."""
    go = graph_objects()
    rungs = ladder.rungs
    errors = [rung.comparison.errors for rung in rungs]
    names = [_step(rung) for rung in rungs]
    steps = [f"{number} {name}" for number, name in enumerate(names)]
    figure, least = go.Figure(), _LEAST_SHOWN * max(each.held_out_percent for each in errors)
    floors = [rung.comparison.noise_floor_percent for rung in rungs]
    noise = [floor if floor > least else None for floor in floors]
    for title, values, colour, symbol in (
        ("sensor noise alone", noise, "muted", "line-ns"),
        ("fit error", [each.percent for each in errors], "blue", "circle-open"),
        ("test error", [each.held_out_percent for each in errors], "vermillion", "square"),
    ):
        if not any(values):
            continue
        figure.add_trace(
            go.Scatter(
                x=values,
                y=steps,
                name=title,
                mode="markers",
                marker={
                    "symbol": symbol,
                    "size": 10,
                    "color": LIGHT[colour],
                    "line": {"width": 2, "color": LIGHT[colour]},
                },
                customdata=[escaped(rung.model) for rung in rungs],
                hovertemplate=f"%{{customdata}}<br>{title}: %{{x:.3g}} %<extra></extra>",
            )
        )
    torque = words("torque", rungs[0].comparison.drive.motion)
    shown = [value for trace in figure.data for value in trace.x if value is not None and value > least]
    figure.update_xaxes(title_text=f"{torque} error [% of the RMS {torque}]", **logarithmic(shown))
    figure.update_yaxes(title_text="", autorange="reversed", tickvals=steps, ticktext=names, showgrid=True)
    first = rungs[0].comparison
    return styled(
        figure, "The error falls", f"{first.train.name}: {first.drive.model.name}", height=130 + 34 * len(rungs)
    )


def _step(rung: Rung) -> str:
    """Return what was added or removed."""
    sign, name = ("+", rung.added) if rung.added else ("−", rung.removed) if rung.removed else ("", "as given")
    return f"{sign} {escaped(name)}".strip()
