"""In which regimes of motion the error lies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, styled

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison


def error_shares(comparison: Comparison) -> Figure:
    """Draw each regime's share of the squared error beside its share of the samples, the worst regime on top.

    Where the error's share is well above the samples', the model fails there.
    """
    go = graph_objects()
    rows = comparison.where[::-1]
    names = [escaped(row.regime) for row in rows]
    figure = go.Figure()
    x = [each for row in rows for each in (100 * row.share_of_samples, 100 * row.share_of_squared_error, None)]
    y = [each for name in names for each in (name, name, None)]
    figure.add_trace(
        go.Scatter(
            x=x, y=y, mode="lines", line={"color": LIGHT["axis"], "width": 2}, hoverinfo="skip", showlegend=False
        )
    )
    for title, values, colour, symbol in (
        ("share of samples", [100 * row.share_of_samples for row in rows], "measured", "circle-open"),
        ("share of squared error", [100 * row.share_of_squared_error for row in rows], "vermillion", "square"),
    ):
        figure.add_trace(
            go.Scatter(
                x=values,
                y=names,
                name=title,
                mode="markers",
                marker={
                    "color": LIGHT[colour],
                    "symbol": symbol,
                    "size": 10,
                    "line": {"width": 2, "color": LIGHT[colour]},
                },
                hovertemplate=f"%{{y}}: {title} %{{x:.1f}} %<extra></extra>",
            )
        )
    figure.update_xaxes(title_text="share [%]", rangemode="tozero")
    figure.update_yaxes(title_text="", showgrid=True)
    drive = comparison.drive
    subtitle = f"{comparison.train.name}: {drive.model.name}"
    return styled(figure, "Where the error lies", subtitle, height=150 + 24 * len(rows))
