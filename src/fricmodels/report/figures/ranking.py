"""All candidates that were tested, ranked by how much of the error they take away."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fricmodels.report.figures.style import LIGHT, SUPERSCRIPT, Figure, escaped, graph_objects, styled
from fricmodels.results.words import LEAST_CHANCE

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
    changes = [0.0, *(row.change for row in shown if row.change is not None)]
    middle = 0.5 * (min(changes) + max(changes))  # where the room beside a point is on its other side
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
                mode="markers+text",
                text=[f"  p {chance(row.p_value)}  " for row in own],
                textposition=["middle right" if (row.change or 0.0) < middle else "middle left" for row in own],
                textfont={"size": 11, "color": LIGHT["muted"]},
                marker={"color": LIGHT[colour], "symbol": symbol, "size": 10, "line": {"width": 1.5}},
                hovertemplate="%{y}: %{x:.1f} %, p = %{customdata:.1g}<extra></extra>",
            )
        )
    figure.update_yaxes(
        title_text="", categoryorder="array", categoryarray=[escaped(row.name) for row in shown], showgrid=True
    )
    figure.update_xaxes(title_text="change on test blocks [%]")
    return styled(figure, "All candidates", model, height=120 + 22 * len(shown))


def chance(p_value: float | None) -> str:
    """Return a probability as ``= 0.002`` or ``< 10⁻⁶``, below which the number means nothing."""
    if p_value is None:
        return "–"
    return "< 10⁻⁶" if p_value < LEAST_CHANCE else f"= {p_value:.1g}" if p_value >= 1e-4 else f"= {_powers(p_value)}"


def _powers(p_value: float) -> str:
    digit, _, power = f"{p_value:.0e}".partition("e")
    return f"{digit}×10{str(int(power)).translate(SUPERSCRIPT)}"
