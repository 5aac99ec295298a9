"""A result as HTML, and as plain text: what it is, its figures, its tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import singledispatch
from html import escape
from textwrap import fill

import numpy as np
import pandas as pd

from fricmodels.diagnosis import Comparison, Diagnosis, Ladder
from fricmodels.diagnosis.explain import explain
from fricmodels.dimension import FORCE
from fricmodels.fit import Fit
from fricmodels.logcheck import Severity, findings
from fricmodels.notebook.figures import drawn, figure_html
from fricmodels.notebook.tables import Tables, tables
from fricmodels.recording import Recording
from fricmodels.tournament import Leaderboard

_MOST_ROWS, _LINE = 60, 100
_MOST_CHECKED = 500_000
"""Samples of a recording that is checked where it shows itself: two seconds."""
_IDENTITY = ("rank", "model", "estimator", "dataset")
_FIGURES = {
    "held_out_rms_torque_error_percent": "test error [%]",
    "rms_torque_error_percent": "fit error [%]",
    "seconds": "seconds",
}


@dataclass(frozen=True)
class Story:
    """What is shown of a result.

    Attributes:
        title, text: what it is, in words.
        tables: by title.
        figures: the names of functions of :mod:`fricmodels.report.figures`, each with what it draws.
    """

    title: str
    text: str
    tables: Tables
    figures: Sequence[tuple[str, object]] = field(default=())


def html(result: object) -> str:
    """Return a result as a piece of HTML: what it is, its figures, its tables.

    Where figures tell the story, only the first two tables are open.

    Raises:
        TypeError: for what is no result.
    """
    story = _story(result)
    figures = drawn(story.figures)
    parts = [f"<p><strong>{escape(story.title)}</strong></p>", f"<p>{escape(story.text)}</p>"]
    parts += [figure_html(figure) for figure in figures]
    for number, (heading, table) in enumerate(story.tables.items()):
        content = _table_html(table) if len(table) else "<p>none</p>"
        still = " open" if number < 2 or not figures else ""
        summary = f"<summary><strong>{escape(heading)}</strong></summary>"
        parts.append(f'<details{still} style="margin: 0.5em 0">{summary}{content}</details>')
    return '<div class="fricmodels-result">' + "\n".join(parts) + "</div>"


def text(result: object) -> str:
    """Return a result as plain text: what it is, and the table that sums it up.

    Raises:
        TypeError: for what is no result.
    """
    story = _story(result)
    heading, table = next(iter(story.tables.items()))
    content = _shown(table).to_string(index=False, na_rep="", float_format="{:.5g}".format, max_rows=_MOST_ROWS)
    return f"{story.title}\n{fill(story.text, _LINE)}\n\n{heading}\n{content if len(table) else 'none'}"


@singledispatch
def _story(result: object) -> Story:
    raise TypeError(f"{type(result).__name__} does not show itself")


@_story.register
def _(recording: Recording) -> Story:
    runs = len(recording.run_numbers)
    duration = sum(float(np.ptp(part.time)) for part in recording.runs())
    rate = f", sampled every {1000 * recording.interval:.4g} ms" if np.isfinite(recording.interval) else ""
    said = (
        f"{len(recording)} samples in {runs} run{'s' * (runs > 1)}, {duration:.4g} s{rate}; {recording.motion.value}."
    )
    return Story(f"Recording {recording.name}", " ".join([said, *_what_is_the_matter(recording)]), tables(recording))


def _what_is_the_matter(recording: Recording) -> Iterator[str]:
    """Yield a sentence for each thing that the check of a log stops at or warns of."""
    if len(recording) > _MOST_CHECKED:
        yield "It is too long to be checked here; 'fricmodels info' does it."
        return
    for finding in findings(recording):
        if finding.severity is not Severity.NOTE:
            yield f"{'Stop' if finding.severity is Severity.STOP else 'Warning'}: {finding}."


@_story.register
def _(fit: Fit) -> Story:
    said = f"{fit.status.value}{': ' * bool(fit.message)}{fit.message}; {fit.seconds:.3g} s"
    if fit.not_identified:
        said += f"; not identified: {', '.join(fit.not_identified)}"
    figures = [("parameter_history", fit)] if fit.history is not None else []
    return Story(f"{fit.model} by {fit.estimator} on {fit.dataset}", said, tables(fit), figures)


@_story.register
def _(comparison: Comparison) -> Story:
    said = comparison.errors.in_words(FORCE.unit(comparison.drive.motion))
    figures = [(name, comparison) for name in ("overlay", "friction_curve", "error_shares")]
    return Story(f"{comparison.drive.model.name} on {comparison.train.name}", said, tables(comparison), figures)


@_story.register
def _(diagnosis: Diagnosis) -> Story:
    comparison = diagnosis.comparison
    names = ("residual_map", "residual_spectrum") if "position" in comparison.train else ("error_shares",)
    figures = [(name, comparison) for name in names]
    return Story(f"Verdict: {diagnosis.verdict}", explain(diagnosis), tables(diagnosis), figures)


@_story.register
def _(ladder: Ladder) -> Story:
    first, last = ladder.rungs[0], ladder.rungs[-1]
    title = f"From {first.model} to {last.model}" if len(ladder.rungs) > 1 else f"{first.model}, as it was"
    figures = [("ladder", ladder), ("friction_curve", last.comparison)]
    return Story(title, explain(ladder.first, ladder), tables(ladder), figures)


@_story.register
def _(board: Leaderboard) -> Story:
    whole = tables(board)["Leaderboard"]
    failures = len(board.failures)
    fits = f"{len(board.rows)} fit{'s' * (len(board.rows) != 1)}"
    said = f"{fits}{f', {failures} without a result' * bool(failures)}, ranked by the torque error."
    if not len(whole):
        return Story("Leaderboard", said, {"Ranks": whole})
    varied = [f"tag.{tag}" for tag in board.tags if whole[f"tag.{tag}"].astype(str).nunique() > 1]
    unusual = ["status", "message"] if failures else []
    columns = [*_IDENTITY, *varied, *(column for column in [*_FIGURES, *unusual] if column in whole)]
    short = (
        whole[columns].set_index("rank").rename(columns=_FIGURES).rename(columns=lambda name: name.removeprefix("tag."))
    )
    figures = [("leaderboard", board.rows)] if failures < len(board.rows) else []
    return Story("Leaderboard", said, {"Ranks": short}, figures)


def _shown(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with its index as a column, without columns that say nothing."""
    whole = table.reset_index()
    return whole.loc[:, [any(_cell(value) for value in whole[name]) for name in whole.columns]]


def _table_html(table: pd.DataFrame) -> str:
    """Return a table: numbers to the right, text to the left, nothing in it taken for HTML; a wide one scrolls."""
    whole = _shown(table)
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
        f'<{tag} style="text-align: {side}; padding: 0.15em 0.8em">{escape(cell)}</{tag}>'
        for side, cell in zip(sides, cells, strict=True)
    )
    return f"<tr>{''.join(listed)}</tr>"


def _cell(value: object) -> str:
    if isinstance(value, bool | np.bool_):
        return "yes" if value else ""
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.5g}"
    return "" if value is None else str(value)
