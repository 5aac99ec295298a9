"""The formats in which a leaderboard is written.

Names in a leaderboard come from files and plugins, so every format escapes what its readers would take for markup or
for a formula.
"""

from __future__ import annotations

import csv
import html
import io
import json
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fricmodels.errors import InputError, suggestion
from fricmodels.export.columns import Column, Titled, frame, tables

if TYPE_CHECKING:
    from fricmodels.tournament.leaderboard import Leaderboard

_LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "%": r"\%",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}
_LONG = 40
"""Rows of a table in LaTeX that fit a page."""
_MARKDOWN = set("\\`*_{}[]<>#|~$")


def export(board: Leaderboard, form: str) -> bytes:
    """Return a leaderboard in one of :data:`FORMATS`.

    Raises:
        InputError: for an unknown format.
    """
    if form not in FORMATS:
        raise InputError(f"unknown format '{form}'{suggestion(form, FORMATS)}")
    return FORMATS[form](board)


def _table(board: Leaderboard) -> bytes:
    return "\n".join(_aligned(each.columns) for each in tables(board)).encode()


def _aligned(columns: Sequence[Column]) -> str:
    widths = [max(len(column.title), *map(len, column.cells), 0) for column in columns]
    lines = ["  ".join(column.title.ljust(width) for column, width in zip(columns, widths, strict=True)).rstrip()]
    lines.append("  ".join("─" * width for width in widths))
    for cells in _rows(columns):
        aligned = [
            cell.rjust(width) if column.number else cell.ljust(width)
            for cell, column, width in zip(cells, columns, widths, strict=True)
        ]
        lines.append("  ".join(aligned).rstrip())
    return _text(lines)


def _markdown(board: Leaderboard) -> bytes:
    found = tables(board)
    if len(found) == 1:
        return markdown(found[0].columns).encode()
    return "\n".join(f"{_in_markdown(each.title)}:\n\n{markdown(each.columns)}" for each in found).encode()


def markdown(columns: Sequence[Column]) -> str:
    """Return a table in Markdown."""
    lines = ["| " + " | ".join(_in_markdown(column.title) for column in columns) + " |"]
    lines.append("|" + "|".join("---:" if column.number else "---" for column in columns) + "|")
    lines.extend("| " + " | ".join(map(_in_markdown, cells)) + " |" for cells in _rows(columns))
    return _text(lines)


def _in_markdown(text: str) -> str:
    return "".join("\\" + c if c in _MARKDOWN else c for c in _one_line(text))


def _csv(board: Leaderboard) -> bytes:
    table = frame(board)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([_in_spreadsheet(name) for name in table.columns])
    for values in table.astype(object).itertuples(index=False, name=None):
        writer.writerow(["" if value is None or value != value else _in_spreadsheet(value) for value in values])
    return stream.getvalue().encode()


def _in_spreadsheet(value: Any) -> Any:
    """Keep text from being taken for a formula, or for a row of its own."""
    if not isinstance(value, str):
        return value
    text = _one_line(value)
    return "'" + text if unicodedata.normalize("NFKC", text.lstrip()).startswith(("=", "+", "-", "@")) else text


def _one_line(text: str) -> str:
    """Return text without line ends, and without characters that are not seen but steer how others are."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in " ".join(text.split()))


def _json(board: Leaderboard) -> bytes:
    from fricmodels.results.leaderboard import SCHEMA

    return (json.dumps({"schema": SCHEMA, "rows": list(board.rows)}, indent=1, ensure_ascii=False) + "\n").encode()


def _parquet(board: Leaderboard) -> bytes:
    stream = io.BytesIO()
    table = frame(board)
    for name in table.columns:
        kinds = {type(value) for value in table[name].dropna()}
        if len(kinds) > 1 or kinds & {list, dict}:
            table[name] = table[name].map(lambda value: None if value is None else str(value))
    table.to_parquet(stream, index=False)
    return stream.getvalue()


def _html(board: Leaderboard) -> bytes:
    lines = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8"><title>Leaderboard</title><style>',
        "body{font:15px/1.5 system-ui,sans-serif;margin:2rem}table{border-collapse:collapse;margin-bottom:2rem}",
        "th,td{padding:.25rem .75rem;border-bottom:1px solid #ccc;text-align:left}",
        "td.number{text-align:right;font-variant-numeric:tabular-nums}",
        "</style></head><body><h1>Leaderboard</h1>",
        *(line for each in tables(board) for line in _html_table(each)),
        "</body></html>",
    ]
    return _text(lines).encode()


def _html_table(each: Titled) -> list[str]:
    columns = each.columns
    titles = "".join(f"<th>{html.escape(_one_line(column.title))}</th>" for column in columns)
    caption = f"<caption>{html.escape(_one_line(each.title))}</caption>"
    lines = [f"<table>{caption}<thead><tr>{titles}</tr></thead><tbody>"]
    for cells in _rows(columns):
        inside = "".join(
            f"{'<td class=number>' if column.number else '<td>'}{html.escape(_one_line(cell))}</td>"
            for cell, column in zip(cells, columns, strict=True)
        )
        lines.append(f"<tr>{inside}</tr>")
    return [*lines, "</tbody></table>"]


def _latex(board: Leaderboard) -> bytes:
    head = "% \\usepackage{booktabs,longtable}\n"
    found = tables(board)
    labels = ["tab:leaderboard", *(f"tab:leaderboard-{number}" for number in range(2, len(found) + 1))]
    texts = (latex(each.columns, each.title, label) for each, label in zip(found, labels, strict=True))
    return (head + "\n".join(texts)).encode()


def latex(columns: Sequence[Column], title: str, label: str) -> str:
    """Return a table in LaTeX with the rules of ``booktabs``; a long one as ``longtable``, which goes over pages.

    Args:
        columns: of the table.
        title: its caption.
        label: by which a text refers to it.
    """
    layout = "".join("r" if column.number else "l" for column in columns)
    head = " & ".join(_in_latex(column.title) for column in columns) + r" \\"
    body = [" & ".join(map(_in_latex, cells)) + r" \\" for cells in _rows(columns)]
    caption = rf"\caption{{{_in_latex(title)}}}\label{{{label}}}"
    if len(body) > _LONG:
        again = [r"\toprule", head, r"\midrule"]
        lines = [rf"\begin{{longtable}}{{{layout}}}", caption + r" \\", *again, r"\endfirsthead", *again, r"\endhead"]
        lines += [r"\bottomrule", r"\endfoot", *body, r"\end{longtable}"]
        return _text(lines)
    lines = [r"\begin{table}", r"\centering", caption, rf"\begin{{tabular}}{{{layout}}}"]
    return _text([*lines, r"\toprule", head, r"\midrule", *body, r"\bottomrule", r"\end{tabular}", r"\end{table}"])


def _in_latex(text: str) -> str:
    return "".join(_LATEX.get(c, c) for c in _one_line(text))


def _rows(columns: Sequence[Column]) -> list[tuple[str, ...]]:
    return list(zip(*(column.cells for column in columns), strict=True))


def _text(lines: Sequence[str]) -> str:
    return "\n".join(lines) + "\n"


FORMATS: Mapping[str, Callable[[Leaderboard], bytes]] = {
    "table": _table,
    "md": _markdown,
    "csv": _csv,
    "json": _json,
    "parquet": _parquet,
    "html": _html,
    "latex": _latex,
}
"""How to write a leaderboard, by the name of the format."""
