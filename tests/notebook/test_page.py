"""The notebook pages of the documentation show what their code gives."""

from __future__ import annotations

import ast
import json
import re
import runpy
from html.parser import HTMLParser
from itertools import takewhile
from pathlib import Path
from typing import Any

import pytest

PAGES = sorted((Path(__file__).parents[2] / "docs" / "notebook").glob("*.ipynb"))
VARIES = {"seconds"}
"""Columns that are another time another."""

Table = list[list[str]]


class Tables(HTMLParser):
    """The tables of a piece of HTML, as text."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tables: list[Table] = []
        self.inside = False
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
            self.inside = True

    def handle_endtag(self, tag: str) -> None:
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data: str) -> None:
        if self.inside:
            self.tables[-1][-1][-1] += data


def steady(table: Table) -> Table:
    """Return a table without the columns that vary."""
    kept = [i for i, title in enumerate(table[0]) if title not in VARIES]
    return [[row[i] for i in kept if i < len(row)] for row in table]


def same(shown: str, found: str) -> bool:
    """Whether two texts are equal, numbers as far as another processor gives them."""
    number = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
    one, two = number.findall(shown), number.findall(found)
    near = [abs(float(a) - float(b)) <= 0.01 * abs(float(b)) + 5e-4 for a, b in zip(one, two, strict=False)]
    return number.sub("#", shown) == number.sub("#", found) and len(one) == len(two) and all(near)


def code(page: Path) -> list[tuple[str, list[dict[str, Any]]]]:
    cells = json.loads(page.read_text(encoding="utf-8"))["cells"]
    return [("".join(cell["source"]), cell["outputs"]) for cell in cells if cell["cell_type"] == "code"]


def script(cells: list[tuple[str, list[dict[str, Any]]]]) -> str:
    """Return the code of cells as a program that collects what each of them shows in the list ``shown``."""
    lines = ["shown = []"]
    for source, _ in cells:
        tree = ast.parse(source)
        last = tree.body[-1]
        if isinstance(last, ast.Expr) and not (
            isinstance(last.value, ast.Call) and ast.unparse(last).startswith("print")
        ):
            tree.body[-1] = ast.parse(f"shown.append({ast.unparse(last.value)})").body[0]
            lines.append(ast.unparse(tree))
        else:
            lines += [ast.unparse(tree), "shown.append(None)"]
    return "\n".join(lines)


@pytest.mark.parametrize("whole", [False, pytest.param(True, marks=pytest.mark.long)], ids=["beginning", "whole"])
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_page_shows_what_its_code_gives(
    page: Path, whole: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """All cells, or those before the first that takes long."""
    cells = code(page)
    if not whole:
        cells = list(takewhile(lambda cell: "= diagnose(" not in cell[0], cells))
    program = tmp_path / "page.py"
    program.write_text(script(cells), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    given = runpy.run_path(str(program))["shown"]
    printed = "".join("".join(o["text"]) for _, outputs in cells for o in outputs if o["output_type"] == "stream")
    assert same(printed, capsys.readouterr().out)
    compared = 0
    for (source, outputs), result in zip(cells, given, strict=True):
        shown = ["".join(o["data"]["text/html"]) for o in outputs if "text/html" in o.get("data", {})]
        if result is None:
            assert not shown, source
            continue
        (html,) = shown
        tables, own = Tables(html).tables, Tables(result._repr_html_()).tables
        assert len(tables) == len(own) > 0
        for one, two in zip(tables, own, strict=True):
            for left, right in zip(steady(one), steady(two), strict=True):
                wrong = [pair for pair in zip(left, right, strict=True) if not same(*pair)]
                assert not wrong, f"{source}\nrun again: python docs/notebook/execute.py"
                compared += len(left)
    assert compared > (100 if whole else 50)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_page_is_executed_small_and_without_traces_of_a_machine(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert len(text) < 2_000_000
    assert all(outputs or "=" in source for source, outputs in code(page))
    assert not [o for _, outputs in code(page) for o in outputs if o["output_type"] == "error"]
    assert "/tmp/" not in text


def test_there_is_a_page_in_the_navigation() -> None:
    navigation = (Path(__file__).parents[2] / "mkdocs.yml").read_text(encoding="utf-8")
    assert PAGES
    assert all(f"notebook/{page.name}" in navigation for page in PAGES)
