"""All candidates that were tested, ranked by how much of the error they take away."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, styled

if TYPE_CHECKING:
    from fricmodels.results.diagnosis import Candidate

MOST = 8
"""Candidates that are drawn; the table has all."""


def candidates(best: Sequence[Candidate], model: str = "") -> Figure:
    """Draw by how much the error on test blocks changes with each candidate, the best on top.

    Args:
        best: the candidates, the best first.
        model: the model that they were added to.
    """
    shown = best[:MOST][::-1]
    figure = graph_objects().Figure()
    for passes, name, colour, symbol in (
        (True, "passes all three tests", "vermillion", "square"),
        (False, "fails one of them", "muted", "circle-open"),
    ):
        own = [row for row in shown if row.gates is passes]
        figure.add_trace(
            graph_objects().Scatter(
                x=[None if row.change is None else 100 * row.change for row in own],
                y=[escaped(row.name) for row in own],
                customdata=[row.p_value for row in own],
                name=name,
                mode="markers",
                marker={"color": LIGHT[colour], "symbol": symbol, "size": 10, "line": {"width": 1.5}},
                hovertemplate="%{y}: %{x:.1f} %, p = %{customdata:.1g}<extra></extra>",
            )
        )
    figure.update_yaxes(
        title_text="", categoryorder="array", categoryarray=[escaped(row.name) for row in shown], showgrid=True
    )
    figure.update_xaxes(title_text="change of the error on test blocks [%]")
    return styled(figure, "All candidates", model, height=130 + 24 * len(shown))
