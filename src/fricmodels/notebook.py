"""How results look in a notebook: tables as DataFrames, HTML with figures where Plotly is installed.

Plotly's JavaScript comes from its content delivery network, once a page. Where there is no network, run
``plotly.offline.init_notebook_mode()`` first, which puts it into the notebook; the tables say the same in any case.
Every name is escaped: recordings, models and plugins are called what others have called them.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Callable, Mapping, Sequence
from functools import singledispatch
from html import escape
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from fricmodels.diagnosis import Comparison, Diagnosis, Ladder
from fricmodels.diagnosis.diagnose import Finding
from fricmodels.diagnosis.explain import explain
from fricmodels.diagnosis.ladder import added
from fricmodels.dimension import DIMENSIONLESS, FORCE, INERTIA
from fricmodels.export.columns import frame
from fricmodels.fit import Fit
from fricmodels.recording import CHANNELS, Recording
from fricmodels.tournament import Leaderboard

if TYPE_CHECKING:
    import plotly.graph_objects as go

Tables = dict[str, pd.DataFrame]

_MOST_ROWS = 60
_OTHER_UNITS = {"current": "A", "temperature": "°C"}
_CONCISE = ("rank", "model", "estimator", "dataset")
_FIGURES = ("held_out_rms_torque_error_percent", "rms_torque_error_percent", "seconds", "status", "message")
_count = itertools.count()


# ---- tables ----------------------------------------------------------------------------------------------------------


@singledispatch
def tables(result: object) -> Tables:
    """Return the tables of a result by title, the one that sums it up first.

    Raises:
        TypeError: for what is no result.
    """
    raise TypeError(f"{type(result).__name__} has no tables")


@tables.register
def _(recording: Recording) -> Tables:
    rows = {
        name: {
            "unit": _OTHER_UNITS.get(name) or CHANNELS.get(name, DIMENSIONLESS).unit(recording.motion),
            "least": float(np.min(values)),
            "greatest": float(np.max(values)),
            "RMS": float(np.sqrt(np.mean(values**2))),
            "derived": name in recording.derived,
        }
        for name, values in recording.channels.items()
    }
    return {"Channels": _frame(rows, "channel")}


@tables.register
def _(fit: Fit) -> Tables:
    errors = fit.standard_errors
    rows = {
        key: {
            "value": value,
            "standard error": errors.get(key, float("nan")),
            "remark": fit.not_identified.get(key, "" if key in errors else "given"),
        }
        for key, value in fit.parameters.items()
    }
    return {"Parameters": _frame(rows, "parameter", ("value", "standard error", "remark"))}


@tables.register
def _(comparison: Comparison) -> Tables:
    drive, errors, unit = comparison.drive, comparison.errors, FORCE.unit(comparison.drive.motion)
    units = {p.key: p.declared.unit_for(drive.motion) for p in drive.parameters}
    units.setdefault(drive.inertia_key, INERTIA.unit(drive.motion))
    parameters = {
        key: {
            "value": value,
            "standard error": comparison.estimate.standard_errors.get(key, float("nan")),
            "unit": units[key],
            "remark": "" if key in comparison.estimate.standard_errors else "given",
        }
        for key, value in comparison.estimate.parameters.items()
    }
    error = {
        "fitted": {f"RMS [{unit}]": errors.SI, "% of RMS torque": errors.percent},
        "kept back": {"% of RMS torque": errors.held_out_percent},
        "noise alone": {"% of RMS torque": comparison.noise_floor_percent},
    }
    where = {
        row.regime: {
            "share of squared error [%]": 100 * row.share_of_squared_error,
            "share of samples [%]": 100 * row.share_of_samples,
            "samples": row.samples,
            f"RMS error [{unit}]": row.rms_torque_error,
        }
        for row in comparison.where
    }
    return {
        "Parameters": _frame(parameters, "parameter"),
        "Torque error": _frame(error, "data"),
        "Where it fails": _frame(where, "regime"),
    }


@tables.register
def _(diagnosis: Diagnosis) -> Tables:
    return _of_diagnosis(diagnosis.findings, diagnosis)


@tables.register
def _(ladder: Ladder) -> Tables:
    steps = {
        number: {
            "model": rung.model,
            "added": rung.added,
            "removed": rung.removed,
            "error fitted [%]": rung.comparison.errors.percent,
            "error kept back [%]": rung.comparison.errors.held_out_percent,
        }
        for number, rung in enumerate(ladder.rungs)
    }
    estimates = [rung.comparison.estimate for rung in ladder.rungs]
    keys = dict.fromkeys(key for estimate in estimates for key in estimate.parameters)
    parameters = {
        key: {f"step {number}": estimate.parameters.get(key) for number, estimate in enumerate(estimates)}
        for key in keys
    }
    return {
        "The ladder": _frame(steps, "step"),
        "Parameters from step to step": _frame(parameters, "parameter").astype(float),
        **_of_diagnosis(added(ladder), ladder.last),
    }


@tables.register
def _(board: Leaderboard) -> Tables:
    return {"Leaderboard": frame(board)}


def _of_diagnosis(findings: Sequence[Finding], final: Diagnosis) -> Tables:
    motion = final.comparison.drive.motion
    found = {
        finding.tested.name: {
            "explains of the residual [%]": 100 * finding.tested.evidence.explained,
            "lowers error kept back [%]": 100 * finding.tested.evidence.gain,
            "p value, corrected": finding.tested.adjusted,
            "cannot be told from": ", ".join(finding.names[1:]),
            "equation": finding.tested.effect.formula,
        }
        for finding in findings
    }
    headings = ("explains of the residual [%]", "lowers error kept back [%]", "p value, corrected")
    sizes = {
        f"{finding.tested.name}.{p.symbol}": {
            "value": finding.tested.parameters[p.symbol],
            "unit": p.unit_for(motion),
            "meaning": p.meaning,
        }
        for finding in findings
        for p in finding.tested.effect.parameters
    }
    seen = {
        name: {"% of RMS torque": row.smallest_percent, f"RMS torque [{FORCE.unit(motion)}]": row.smallest_torque}
        for name, row in final.visibility.items()
        if not row.missing
    }
    blind = {name: {"why": row.missing} for name, row in final.visibility.items() if row.missing}
    return {
        "What was found": _frame(found, "effect", headings),
        **({"Its size on the residual": _frame(sizes, "parameter")} if sizes else {}),
        **({"Not found, though it would have been from this size on": _frame(seen, "effect")} if seen else {}),
        **({"Could not have been seen in this recording": _frame(blind, "effect")} if blind else {}),
    }


def _frame(rows: Mapping[Any, Mapping[str, Any]], index: str, columns: Sequence[str] = ()) -> pd.DataFrame:
    table = pd.DataFrame.from_dict(dict(rows), orient="index") if rows else pd.DataFrame(columns=list(columns))
    table.index.name = index
    return table


# ---- HTML ------------------------------------------------------------------------------------------------------------


@singledispatch
def html(result: object) -> str:
    """Return a result as a piece of HTML: what it is, its figures, its tables.

    Raises:
        TypeError: for what is no result.
    """
    raise TypeError(f"{type(result).__name__} does not show itself")


@html.register
def _(recording: Recording) -> str:
    runs = len(np.unique(recording.run))
    duration = sum(float(np.ptp(part.time)) for part in recording.runs())
    rate = f", one each {recording.interval:.4g} s" if np.isfinite(recording.interval) else ""
    text = f"{len(recording)} samples in {runs} run{'s' * (runs > 1)}, {duration:.4g} s{rate}; {recording.motion.value}"
    return _block(f"Recording {recording.name}", text, tables(recording))


@html.register
def _(fit: Fit) -> str:
    text = f"{fit.status.value}{': ' * bool(fit.message)}{fit.message}; {fit.seconds:.3g} s"
    if fit.not_identified:
        text += f"; not identified: {', '.join(fit.not_identified)}"
    drawn = [_figures().parameter_history(fit)] if fit.history is not None and _can_draw() else []
    return _block(f"{fit.model} by {fit.estimator} on {fit.dataset}", text, tables(fit), drawn)


@html.register
def _(comparison: Comparison) -> str:
    title = f"{comparison.drive.model.name} on {comparison.train.name}"
    errors = comparison.errors
    text = (
        f"RMS torque error {errors.percent:.4g} % of the RMS motor torque; on data kept back "
        f"{errors.held_out_percent:.4g} %; noise alone would leave about {comparison.noise_floor_percent:.3g} %."
    )
    return _block(title, text, tables(comparison), _drawn(comparison, "overlay", "friction_curve", "error_shares"))


@html.register
def _(diagnosis: Diagnosis) -> str:
    comparison = diagnosis.comparison
    shown = ["residual_map", "residual_spectrum"] if "position" in comparison.train else ["error_shares"]
    return _block(f"Verdict: {diagnosis.verdict}", explain(diagnosis), tables(diagnosis), _drawn(comparison, *shown))


@html.register
def _(ladder: Ladder) -> str:
    title = f"From {ladder.rungs[0].model} to {ladder.rungs[-1].model}"
    drawn = _drawn(ladder, "ladder") + _drawn(ladder.rungs[-1].comparison, "friction_curve")
    return _block(title, explain(ladder.first, ladder), tables(ladder), drawn)


@html.register
def _(board: Leaderboard) -> str:
    whole = frame(board)
    varied = [f"tag.{tag}" for tag in board.tags if whole[f"tag.{tag}"].astype(str).nunique() > 1]
    columns = [*_CONCISE, *varied, *(column for column in _FIGURES if column in whole)]
    shown = whole[columns] if len(whole) else whole
    short = shown.dropna(axis="columns", how="all").set_index("rank") if len(shown) else shown
    short = short.drop(columns="message") if not board.failures and "message" in short else short
    names = map(str, short.columns)
    short.columns = [name.removeprefix("tag.").replace("_percent", " [%]").replace("_", " ") for name in names]
    failures = len(board.failures)
    text = f"{len(board.rows)} fits{f', {failures} without a result' * bool(failures)}, ranked by the torque error."
    good = [row for row in board.rows if row["status"] == "ok"]
    drawn = [_figures().leaderboard(board.rows)] if good and _can_draw() else []
    return _block("Leaderboard", text, {"": short}, drawn)


def _block(title: str, text: str, shown: Mapping[str, pd.DataFrame], figures: Sequence[go.Figure] = ()) -> str:
    """Return title, text, figures and tables; where figures tell the story, only the first two tables are open."""
    parts = [f"<p><strong>{escape(title)}</strong></p>", f"<p>{escape(text)}</p>"]
    parts += [_figure_html(figure) for figure in figures]
    for number, (heading, table) in enumerate(shown.items()):
        content = _table_html(table) if len(table) else "<p>none</p>"
        if not heading:
            parts.append(content)
            continue
        still = " open" if number < 2 or not figures else ""
        summary = f"<summary><strong>{escape(heading)}</strong></summary>"
        parts.append(f'<details{still} style="margin: 0.5em 0">{summary}{content}</details>')
    return '<div class="fricmodels-result">' + "\n".join(parts) + "</div>"


def _table_html(table: pd.DataFrame) -> str:
    """Return a table: numbers to the right, text to the left, nothing in it taken for HTML; a wide one scrolls."""
    whole = table.reset_index()
    numeric = [pd.api.types.is_numeric_dtype(kind) and not pd.api.types.is_bool_dtype(kind) for kind in whole.dtypes]
    head = _row("th", [str(name) for name in whole.columns], numeric)
    rows = [_row("td", [_cell(value) for value in row], numeric) for row in whole[:_MOST_ROWS].itertuples(index=False)]
    more = len(whole) - len(rows)
    note = f"<p>{more} more rows in table()</p>" if more > 0 else ""
    content = f"<table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>"
    return f'<div style="overflow-x: auto">{content}</div>{note}'


def _row(tag: str, cells: Sequence[str], numeric: Sequence[bool]) -> str:
    sides = ("right" if number else "left" for number in numeric)
    listed = (
        f'<{tag} style="text-align: {side}">{escape(cell)}</{tag}>' for side, cell in zip(sides, cells, strict=True)
    )
    return f"<tr>{''.join(listed)}</tr>"


def _cell(value: object) -> str:
    if isinstance(value, bool | np.bool_):
        return "yes" if value else ""
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.5g}"
    return "" if value is None else str(value)


# ---- figures ---------------------------------------------------------------------------------------------------------


def _can_draw() -> bool:
    return find_spec("plotly") is not None


def _figures() -> Any:
    from fricmodels.report import figures

    return figures


def _drawn(result: object, *names: str) -> list[go.Figure]:
    """Return figures of a result by name; none where Plotly is not installed."""
    if not _can_draw():
        return []
    draw: list[Callable[[object], go.Figure]] = [getattr(_figures(), name) for name in names]
    return [each(result) for each in draw]


_SCRIPT = """<div id="{place}" class="fricmodels-figure" role="img" aria-label="{label}"
 style="min-height: {height}px; background: #fff">
</div>
<script>
(function () {{
  const figure = {figure};
  const place = document.getElementById("{place}");
  const draw = () => window.Plotly.newPlot(place, figure.data, figure.layout, {{responsive: true, displaylogo: false}});
  if (window.Plotly) {{ draw(); return; }}
  let script = document.getElementById("fricmodels-plotly");
  if (!script) {{
    script = document.createElement("script");
    script.id = "fricmodels-plotly";
    script.src = "{source}";
    document.head.append(script);
  }}
  script.addEventListener("load", draw);
  script.addEventListener("error", () => {{
    place.style.minHeight = "0";
    place.textContent = "The figure needs Plotly's JavaScript, which could not be loaded; the tables hold its numbers.";
  }});
}})();
</script>"""


def _figure_html(figure: go.Figure) -> str:
    """Return a figure that draws itself once Plotly's JavaScript is there; nothing in it can end the script."""
    from plotly.offline import get_plotlyjs_version

    content = str(figure.to_json())
    for sign in "<>&\u2028\u2029":
        content = content.replace(sign, f"\\u{ord(sign):04x}")
    place = f"fricmodels-{hashlib.sha256(content.encode()).hexdigest()[:12]}-{next(_count)}"
    title = str(figure.layout.title.text or "figure").partition("<br>")[0]
    return _SCRIPT.format(
        place=place,
        label=escape(title),
        height=int(figure.layout.height or 420),
        figure=content,
        source=f"https://cdn.plot.ly/plotly-{get_plotlyjs_version()}.min.js",
    )
