"""Every format holds the same leaderboard, and escapes what its readers would take for markup or a formula."""

from __future__ import annotations

import csv
import io
import json
from html.parser import HTMLParser
from typing import Any

import pandas as pd
import pytest

from fricmodels.errors import InputError
from fricmodels.export import FORMATS, export
from fricmodels.export.columns import tables
from fricmodels.tournament.leaderboard import Leaderboard

NASTY = '=cmd|"<b>&_%|`$'


def board() -> Leaderboard:
    def row(model: str, error: float | None, status: str, seed: int) -> dict[str, Any]:
        return {
            "model": model,
            "estimator": "batch",
            "dataset": NASTY,
            "tags": {"noise_percent": 5.0, "seed": seed},
            "rms_torque_error_percent": error,
            "held_out_rms_torque_error_percent": error,
            "parameters": {"K_v": 1.25e-4} if error else {},
            "standard_errors": {"K_v": None} if error else {},
            "true_parameters": {"K_v": 1e-4},
            "seconds": 0.25,
            "status": status,
            "message": "" if error else "why\nnot",
            "settings": {"mode": "fast", "limit": seed} if seed else {"mode": 3},
        }

    return Leaderboard.ranked([row("b", 2.5, "ok", 1), row("a", 1.5, "ok", 0), row("c", None, "failed", 2)])


def test_csv_is_safe_for_spreadsheets() -> None:
    rows = list(csv.DictReader(io.StringIO(export(board(), "csv").decode())))
    assert [r["model"] for r in rows] == ["a", "b", "c"]
    assert rows[0]["dataset"] == "'" + NASTY
    assert float(rows[1]["held_out_rms_torque_error_percent"]) == 2.5
    assert float(rows[0]["parameter.K_v"]) == 1.25e-4
    assert rows[2]["held_out_rms_torque_error_percent"] == ""
    assert rows[0]["tag.seed"] == "0"


def test_parquet_holds_all() -> None:
    table = pd.read_parquet(io.BytesIO(export(board(), "parquet")))
    assert table["model"].tolist() == ["a", "b", "c"]
    assert table["parameter.K_v"].iloc[0] == 1.25e-4
    assert table["true_parameter.K_v"].iloc[2] == 1e-4
    assert table["dataset"].iloc[0] == NASTY


def test_json_is_the_leaderboard() -> None:
    content = json.loads(export(board(), "json"))
    assert content["rows"] == list(board().rows)


def test_html_shows_names_as_text() -> None:
    class Cells(HTMLParser):
        def __init__(self) -> None:
            super().__init__()
            self.cells: list[str] = []
            self.tags: set[str] = set()

        def handle_starttag(self, tag: str, attrs: Any) -> None:
            self.tags.add(tag)

        def handle_data(self, data: str) -> None:
            self.cells.append(data)

    parser = Cells()
    parser.feed(export(board(), "html").decode())
    assert NASTY in parser.cells
    assert "b" not in parser.tags


def test_markdown_keeps_its_columns() -> None:
    parts = [part.splitlines() for part in export(board(), "md").decode().split("\n\n")]
    assert [title for (title,) in parts[::2]] == ["Over seeds: test error:", "Leaderboard:"], (
        "the medians over seeds come first"
    )
    for lines in parts[1::2]:
        assert len({len(line.replace("\\|", "").split("|")) for line in lines}) == 1
        assert len(lines) == 2 + 3


def test_latex_escapes_names() -> None:
    text = export(board(), "latex").decode()
    assert r"=cmd|\"" not in text
    assert r"<b>\&\_\%|`\$" in text
    body = [line for line in text.split(r"\end{table}")[1].splitlines() if line.endswith(r"\\")]
    assert len({line.replace(r"\&", "").count("&") for line in body}) == 1


def test_latex_has_rules_caption_and_label() -> None:
    text = export(board(), "latex").decode()
    assert text.count(r"\toprule") == text.count(r"\midrule") == text.count(r"\bottomrule") == 2
    assert r"\caption{Leaderboard}\label{tab:leaderboard-2}" in text
    assert r"\hline" not in text


def test_a_long_table_in_latex_goes_over_pages() -> None:
    rows = [{**board().rows[0], "model": f"m{i}", "tags": {}} for i in range(60)]
    text = export(Leaderboard.ranked(rows), "latex").decode()
    assert r"\begin{longtable}" in text
    assert r"\endfirsthead" in text
    assert len([line for line in text.splitlines() if line.endswith(r"\\") and "batch" in line]) == 60


def test_each_dataset_is_ranked_by_itself() -> None:
    own = board().rows[0]
    rows = [{**own, "tags": {}, "dataset": name, "held_out_rms_torque_error_percent": error, "model": model}
            for name, error, model in (("a", 1.0, "x"), ("b", 2.0, "x"), ("b", 1.5, "y"), ("a", 3.0, "y"))]  # fmt: skip
    found = tables(Leaderboard.ranked(rows))
    assert [each.title for each in found] == ["Leaderboard on a", "Leaderboard on b"]
    assert [(c.cells[0], c.cells[1]) for each in found for c in each.columns if c.title in ("rank", "model")] == [
        ("1", "2"), ("x", "y"), ("1", "2"), ("y", "x")
    ]  # fmt: skip
    assert next(each.title for each in tables(Leaderboard.ranked(rows), top=1)) == "Leaderboard on a, the best 1 of 2"


def test_what_is_not_sure_is_marked_and_the_status_stands_beside_the_model() -> None:
    row = {**board().rows[0], "model": "coulomb-viscous", "parameters": {"K_v": 0.0, "K_c": 1.0}, "tags": {}}
    (shown,) = tables(Leaderboard.ranked([{**row, "not_identified": {"K_c": "it does not move"}}]))
    titles = [column.title for column in shown.columns]
    assert titles[:3] == ["rank", "model", "status"]
    assert shown.columns[titles.index("not sure of")].cells == ("K_c? K_v|",)


def test_table_is_aligned_and_ranked() -> None:
    lines = export(board(), "table").decode().split("\n\n")[1].splitlines()
    assert lines[0].startswith("rank")
    assert [line.split()[1] for line in lines[2:]] == ["a", "b", "c"]
    assert lines[-1].endswith("why\nnot".replace("\n", " ")) or "why" in lines[-1]


def test_unknown_format_names_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean 'parquet'"):
        export(board(), "parket")


@pytest.mark.parametrize("form", sorted(FORMATS))
def test_an_empty_leaderboard_is_a_table_without_rows(form: str) -> None:
    assert export(Leaderboard(()), form)
