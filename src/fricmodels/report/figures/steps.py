"""The ladder: how the error falls with each effect that is added."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, logarithmic, styled

if TYPE_CHECKING:
    from fricmodels.diagnosis.ladder import Ladder, Rung


def ladder(ladder: Ladder) -> Figure:
    """Draw the torque error after each step, on what was fitted and on what was kept back, and the noise floor."""
    go = graph_objects()
    rungs = ladder.rungs
    steps = list(range(len(rungs)))
    errors = [rung.comparison.errors for rung in rungs]
    names = [escaped(rung.model) for rung in rungs]
    figure = go.Figure()
    for title, values, colour, dash, symbol in (
        ("fitted", [each.percent for each in errors], "blue", "4px,2px", "circle-open"),
        ("kept back", [each.held_out_percent for each in errors], "vermillion", "solid", "square"),
        ("sensor noise alone", [rung.comparison.noise_floor_percent for rung in rungs], "muted", "dot", None),
    ):
        figure.add_trace(
            go.Scatter(
                x=steps,
                y=values,
                name=title,
                mode="lines+markers" if symbol else "lines",
                line={"color": LIGHT[colour], "width": 2, "dash": dash},
                marker={"symbol": symbol, "size": 9},
                customdata=names,
                hovertemplate=f"%{{customdata}}<br>{title}: %{{y:.3g}} %<extra></extra>",
            )
        )
    figure.update_xaxes(
        title_text="step",
        tickvals=steps,
        ticktext=[_step(rung) for rung in rungs],
        range=[-0.4, len(rungs) - 0.6],
        zeroline=False,
    )
    shown = [value for trace in figure.data for value in trace.y]
    figure.update_yaxes(title_text="torque error [% of the RMS torque]", **logarithmic(shown))
    first = rungs[0].comparison
    return styled(figure, "The error falls", f"{first.train.name}: {first.drive.model.name}", height=440)


def _step(rung: Rung) -> str:
    """Return what was added or removed, broken at its hyphens."""
    sign, name = ("+", rung.added) if rung.added else ("−", rung.removed) if rung.removed else ("", "as given")
    return f"{sign} {escaped(name)}".strip().replace("-", "-<br>") if sign else name
