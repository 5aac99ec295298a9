"""Pictures of many fits: the leaderboard, and the confusion matrix of the hidden-effect challenge."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.errors import InputError
from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, series, styled

if TYPE_CHECKING:
    import pandas as pd

HELD_OUT = "held_out_rms_torque_error_percent"
FITTED = "rms_torque_error_percent"
_MOST_MODELS = 30


@dataclass(frozen=True)
class Entry:
    """One model with one estimator, over recordings and seeds.

    Attributes:
        low, middle, high: quartiles of the torque error [%]; where as many fits failed, the median is infinite, and
            the upper quartile is the worst that did not fail.
        fits, failed: how many there are.
    """

    low: float
    middle: float
    high: float
    fits: int
    failed: int


def entries(rows: Sequence[Mapping[Any, Any]], column: str) -> dict[tuple[str, str], Entry]:
    """Return the quartiles of a column over recordings and seeds, by model and estimator.

    A fit without a result counts as infinitely bad, so that failing is no advantage.
    """
    groups: dict[tuple[str, str], list[float]] = {}
    for row in rows:
        value: Any = row.get(column)
        good = row["status"] == "ok" and _number(value)
        groups.setdefault((row["model"], row["estimator"]), []).append(float(value) if good else math.inf)
    found = {}
    for key, values in groups.items():
        ordered, failed = sorted(values), sum(math.isinf(value) for value in values)
        low, middle, high = (_quantile(ordered, share) for share in (0.25, 0.5, 0.75))
        worst = ordered[len(ordered) - failed - 1] if failed < len(ordered) else math.inf
        found[key] = Entry(low, middle, min(high, worst), len(values), failed)
    return found


def leaderboard(rows: Sequence[Mapping[str, Any]] | pd.DataFrame) -> Figure:
    """Draw the torque error of every model with every estimator: median and quartiles over recordings and seeds.

    Args:
        rows: of ``leaderboard.json``, or the same as a table.

    Raises:
        InputError: when there are no rows.
    """
    go = graph_objects()
    listed = _records(rows)
    if not listed:
        raise InputError("the leaderboard has no rows; run a tournament with at least one model")
    column = HELD_OUT if any(_number(row.get(HELD_OUT)) for row in listed) else FITTED
    found = entries(listed, column)
    models = sorted(
        {model for model, _ in found}, key=lambda m: min(entry.middle for key, entry in found.items() if key[0] == m)
    )[:_MOST_MODELS]
    estimators = list(dict.fromkeys(row["estimator"] for row in listed))
    figure = go.Figure()
    for i, estimator in enumerate(estimators):
        colour, _, symbol = series(i)
        shown = [(n, found[model, estimator]) for n, model in enumerate(models) if (model, estimator) in found]
        shown = [(n, entry) for n, entry in shown if math.isfinite(entry.middle)]
        middle = [entry.middle for _, entry in shown]
        shift = 0.45 * (i - (len(estimators) - 1) / 2) / len(estimators)
        figure.add_trace(
            go.Scatter(
                x=middle,
                y=[n + 0.18 + shift for n, _ in shown],
                name=escaped(estimator),
                mode="markers",
                marker={"color": colour, "symbol": symbol, "size": 9},
                error_x={
                    "type": "data",
                    "symmetric": False,
                    "array": [entry.high - entry.middle for _, entry in shown],
                    "arrayminus": [entry.middle - entry.low for _, entry in shown],
                    "color": colour,
                    "thickness": 1.5,
                    "width": 4,
                },
                customdata=[[escaped(models[n]), entry.fits, entry.failed] for n, entry in shown],
                hovertemplate=(
                    "%{customdata[0]}<br>"
                    + escaped(estimator)
                    + ": %{x:.3g} %<br>%{customdata[1]} fits, %{customdata[2]} without result<extra></extra>"
                ),
            )
        )
    fits = {model: [entry for (m, _), entry in found.items() if m == model] for model in models}
    failures = {model: sum(entry.failed for entry in fits[model]) for model in models}
    for n, model in enumerate(models):
        text = f"{n + 1}. {escaped(model)}"
        if failures[model]:
            text += f"<br>    <i>no result: {failures[model]} of {sum(entry.fits for entry in fits[model])} fits</i>"
        figure.add_annotation(
            x=0, xref="paper", xanchor="left", y=n - 0.54, yref="y", yanchor="top", showarrow=False, align="left",
            text=text, font={"size": 12, "color": LIGHT["text"]},
        )  # fmt: skip
    for n in range(1, len(models)):
        figure.add_hline(y=n - 0.56, line={"color": LIGHT["grid"], "width": 1}, layer="below")
    kind = "kept back" if column == HELD_OUT else "fitted"
    figure.update_xaxes(title_text=f"torque error, {kind} [% of the RMS torque]", rangemode="tozero")
    figure.update_yaxes(range=[len(models) - 0.4, -0.6], showticklabels=False, showgrid=False, ticks="", zeroline=False)
    return styled(
        figure,
        "Leaderboard",
        "median and quartiles over recordings and seeds",
        150 + (74 if any(failures.values()) else 58) * len(models),
    )


def _quantile(ordered: Sequence[float], share: float) -> float:
    """Return a quantile of sorted values, interpolated; between a finite and an infinite one it is infinite."""
    position = share * (len(ordered) - 1)
    below = ordered[math.floor(position)]
    above = ordered[math.ceil(position)]
    return below if below == above else below + (position - math.floor(position)) * (above - below)


def _records(rows: Sequence[Mapping[str, Any]] | pd.DataFrame) -> Sequence[Mapping[Any, Any]]:
    import pandas as pd

    return rows.to_dict("records") if isinstance(rows, pd.DataFrame) else rows


def _number(value: Any) -> bool:
    return value is not None and math.isfinite(value)


def confusion(table: pd.DataFrame) -> Figure:
    """Draw how often each hidden effect was named as which.

    Args:
        table: counts; rows are the hidden effects, columns what was named.
    """
    counts = table.to_numpy(dtype=float)
    totals = counts.sum(axis=1, keepdims=True)
    share = np.divide(100 * counts, totals, out=np.zeros_like(counts), where=totals > 0)
    hidden, named = ([escaped(name) for name in axis] for axis in (table.index, table.columns))
    figure = graph_objects().Figure(
        graph_objects().Heatmap(
            x=named,
            y=hidden,
            z=np.where(counts > 0, share, np.nan).astype(np.float32),
            text=[[f"{value:.0f}" if value else "" for value in row] for row in counts],
            texttemplate="%{text}",
            textfont={"size": 9, "color": LIGHT["text"]},
            customdata=counts.astype(np.float32),
            zmin=0,
            zmax=100,
            colorscale=[[0, LIGHT["few"]], [1, LIGHT["some"]]],
            showscale=False,
            xgap=1,
            ygap=1,
            hoverongaps=False,
            hovertemplate="hidden: %{y}<br>named: %{x}<br>%{customdata:.0f} times, %{z:.0f} %<extra></extra>",
        )
    )
    figure.update_xaxes(title_text="named effect [count]", tickangle=-90, showgrid=False)
    figure.update_yaxes(title_text="hidden effect", autorange="reversed", showgrid=False, dtick=1)
    return styled(figure, "What hidden effects were named", "", 220 + 22 * len(hidden))
