"""The picture of many fits: the leaderboard."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fricmodels.errors import InputError
from fricmodels.report.figures.style import LIGHT, Figure, escaped, graph_objects, logarithmic, series, styled
from fricmodels.tournament.leaderboard import FITTED, HELD_OUT, quantile

if TYPE_CHECKING:
    import pandas as pd

_MOST_MODELS = 30
_LABEL, _LINE, _GAP = 17, 13, 15
"""Pixels of a name, of the line of an estimator, and between models."""
_WIDE = 15.0
"""Ratio of errors from which the axis is logarithmic."""


@dataclass(frozen=True)
class Entry:
    """One model with one estimator, over recordings and seeds.

    Attributes:
        model, estimator: by name.
        low, middle, high: quartiles of the torque error [%]; where as many fits failed, the median is infinite, and
            the upper quartile is the worst that did not fail.
        fits, failed: how many there are.
    """

    model: str
    estimator: str
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
        low, middle, high = (quantile(ordered, share) for share in (0.25, 0.5, 0.75))
        worst = ordered[len(ordered) - failed - 1] if failed < len(ordered) else math.inf
        found[key] = Entry(*key, low, middle, min(high, worst), len(values), failed)
    return found


def leaderboard(rows: Sequence[Mapping[str, Any]] | pd.DataFrame) -> Figure:
    """Draw the torque error of every model with every estimator: median and quartiles over recordings and seeds.

    Args:
        rows: of ``leaderboard.json``, or the same as a table.

    Raises:
        InputError: when there are no rows.
    """
    listed = _records(rows)
    if not listed:
        raise InputError("the leaderboard has no rows; run a tournament with at least one model")
    column = HELD_OUT if any(_number(row.get(HELD_OUT)) for row in listed) else FITTED
    found = entries(listed, column)
    best = {model: min(entry.middle for (m, _), entry in found.items() if m == model) for model, _ in found}
    models = sorted(best, key=lambda model: best[model])[:_MOST_MODELS]
    estimators = list(dict.fromkeys(row["estimator"] for row in listed))
    figure = graph_objects().Figure()
    below = 0.0
    tops = {}
    for rank, model in enumerate(models, start=1):
        tops[model] = below + _name(figure, rank, model, below, [e for (m, _), e in found.items() if m == model])
        below = tops[model] + _LINE * len(estimators) + _GAP
        if rank < len(models):
            figure.add_hline(y=below - _GAP / 3, line={"color": LIGHT["grid"], "width": 1}, layer="below")
    for i, estimator in enumerate(estimators):
        shown = [(model, found[model, estimator]) for model in models if (model, estimator) in found]
        shown = [(model, entry) for model, entry in shown if math.isfinite(entry.middle)]
        _dots(figure, i, estimator, shown, [tops[model] + _LINE * (i + 0.5) for model, _ in shown])
    ends = [end for entry in found.values() for end in (entry.low, entry.middle, entry.high) if 0 < end < math.inf]
    wide = bool(ends) and max(ends) > _WIDE * min(ends)
    figure.update_xaxes(
        title_text=_measured(listed, column), **(logarithmic(ends) if wide else {"rangemode": "tozero"})
    )
    figure.update_yaxes(range=[below, 0], showticklabels=False, showgrid=False, ticks="", zeroline=False)
    figure.update_layout(showlegend=True)
    several = any(entry.fits > 1 for entry in found.values())
    about = "median and quartiles over recordings and seeds" if several else "one fit each"
    if len(best) > len(models):
        about = f"the best {len(models)} of {len(best)} models; {about}"
    return styled(figure, "Leaderboard", about, round(140 + below))


def _name(figure: Figure, rank: int, model: str, top: float, own: Sequence[Entry]) -> float:
    """Write the model's name, and how many of its fits gave no result; return the height [pixels] of that."""
    failed, fits = sum(entry.failed for entry in own), sum(entry.fits for entry in own)
    note = f"<br>    <i>no result: {failed} of {fits} fits</i>" if failed else ""
    figure.add_annotation(
        x=0, xref="paper", xanchor="left", y=top, yref="y", yanchor="top", showarrow=False, align="left",
        text=f"{rank}. {escaped(model)}{note}", font={"size": 12, "color": LIGHT["text"]},
    )  # fmt: skip
    return _LABEL * (2 if failed else 1) + 3


def _dots(figure: Figure, index: int, name: str, shown: Sequence[tuple[str, Entry]], places: Sequence[float]) -> None:
    """Add the medians and quartiles of one estimator."""
    colour, _, symbol = series(index)
    figure.add_trace(
        graph_objects().Scatter(
            x=[entry.middle for _, entry in shown],
            y=places,
            name=escaped(name),
            mode="markers",
            marker={"color": colour, "symbol": symbol, "size": 9, "line": {"width": 1, "color": LIGHT["text"]}},
            error_x={
                "type": "data",
                "symmetric": False,
                "array": [entry.high - entry.middle for _, entry in shown],
                "arrayminus": [entry.middle - entry.low for _, entry in shown],
                "color": colour,
                "thickness": 1.5,
                "width": 4,
            },
            customdata=[[escaped(model), entry.fits, entry.failed] for model, entry in shown],
            hovertemplate=(
                f"%{{customdata[0]}}<br>{escaped(name)}: %{{x:.3g}} %<br>"
                "%{customdata[1]} fits, %{customdata[2]} without result<extra></extra>"
            ),
        )
    )


def _measured(rows: Sequence[Mapping[Any, Any]], column: str) -> str:
    """Return the title of the axis: what the percentages are of."""
    measures = {row.get("measure") for row in rows} - {None}
    reference = "K_I" if measures == {"paper"} else "RMS torque"
    part = "test error" if column == HELD_OUT else "fit error"
    return f"{part} [% of {reference}]"


def _records(rows: Sequence[Mapping[str, Any]] | pd.DataFrame) -> Sequence[Mapping[Any, Any]]:
    import pandas as pd

    return rows.to_dict("records") if isinstance(rows, pd.DataFrame) else rows


def _number(value: Any) -> bool:
    return value is not None and math.isfinite(value)
