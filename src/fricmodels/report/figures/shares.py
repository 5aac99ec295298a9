"""In which regimes of motion the error lies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fricmodels.dimension import FORCE
from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, label, stroke, styled, unit_of, words

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.diagnosis.where import Regime

MOST_REGIMES = 16
"""Regimes that are drawn: those that every drive with a position has; the table has all."""


def error_shares(comparison: Comparison) -> Figure:
    """Draw the RMS error in each regime beside that of the whole, in groups that divide the motion in different ways.

    The regimes of a group do not overlap. Where one lies well to the right of the line, the model fails there. Of many
    groups those are drawn in which the error is largest.
    """
    from fricmodels.diagnosis.where import grouped

    go = graph_objects()
    motion, whole = comparison.drive.motion, comparison.errors.SI
    groups = drawn_groups(grouped(comparison.where))
    unit = unit_of(FORCE, motion)
    figure = go.Figure()
    rows = [row for group in groups.values() for row in sorted(group, key=lambda row: -row.rms_torque_error)]
    names = [escaped(row.regime) for row in rows]
    x = [each for row in rows for each in (whole, row.rms_torque_error, None)]
    y = [each for name in names for each in (name, name, None)]
    figure.add_trace(stroke(x, y, "", "axis", 2, hoverinfo="skip", showlegend=False))
    figure.add_trace(
        go.Scatter(
            x=[row.rms_torque_error for row in rows],
            y=names,
            name="RMS error in the regime",
            mode="markers",
            customdata=[[100 * row.share_of_squared_error, 100 * row.share_of_samples] for row in rows],
            marker={"color": LIGHT["vermillion"], "symbol": "square", "size": 9},
            hovertemplate=(
                f"%{{y}}: %{{x:.3g}} {unit}<br>%{{customdata[0]:.1f}} % of the squared error<br>"
                "in %{customdata[1]:.1f} % of the samples<extra></extra>"
            ),
        )
    )
    ends = [names[0], names[-1]]
    figure.add_trace(
        stroke([whole, whole], ends, "over all that was fitted", "measured", 1.5, "dash", hoverinfo="skip")
    )
    below = 0
    for group in [*groups.values()][:-1]:
        below += len(group)
        figure.add_hline(y=below - 0.5, line={"color": LIGHT["axis"], "width": 1}, layer="below")
    figure.update_xaxes(title_text=label(f"RMS {words('torque', motion)} error", unit), rangemode="tozero")
    figure.update_yaxes(title_text="", showgrid=True, autorange="reversed", dtick=1)
    figure.update_layout(meta={"rows": len(rows), "regimes": len(comparison.where)})
    subtitle = f"{comparison.train.name}: {comparison.drive.model.name}"
    return styled(figure, "Where the error lies", subtitle, height=120 + 19 * len(rows))


def drawn_groups(groups: Mapping[str, list[Regime]]) -> dict[str, list[Regime]]:
    """Return the first groups of regimes, as many as have room beneath each other on a page."""
    kept: dict[str, list[Regime]] = {}
    for name, own in groups.items():
        if kept and sum(map(len, kept.values())) + len(own) > MOST_REGIMES:
            break
        kept[name] = own
    return kept
