"""Figures draw themselves in a real browser, and say so where their script cannot be loaded."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from fricmodels import compare
from fricmodels.rig.demonstration import hidden

plotly = pytest.importorskip("plotly", reason="figures need plotly")


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page with the same comparison twice, as two cells would show it."""
    rig = hidden().model_copy(update={"samples": 5000})
    recording = rig.simulate().select(slice(None), name="</script><script>document.title = 'taken'</script>")
    result = compare(recording, "coulomb-viscous", rig.inertia)
    page = tmp_path_factory.mktemp("page") / "page.html"
    cells = f"<div>{result._repr_html_()}</div><div>{result._repr_html_()}</div>"
    page.write_text(f"<!doctype html><meta charset=utf-8><title>cells</title>{cells}", encoding="utf-8")
    return page


def opened(chromium: Any, page: Path, script: Path | None) -> tuple[Any, list[str], list[str]]:
    """Return the page, what its console said, and what was asked for from elsewhere."""
    tab = chromium.new_page(viewport={"width": 900, "height": 700})
    said: list[str] = []
    asked: list[str] = []

    def answer(route: Any) -> None:
        asked.append(route.request.url)
        if script is None:
            route.abort()
        else:
            route.fulfill(path=script, content_type="text/javascript")

    tab.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    tab.on("pageerror", lambda error: said.append(str(error)))
    tab.route(re.compile("^https?:"), answer)
    tab.goto(page.as_uri())
    return tab, said, asked


@pytest.mark.long
def test_figures_draw_themselves_and_the_script_is_loaded_once(chromium: Any, shown: Path) -> None:
    script = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"
    tab, said, asked = opened(chromium, shown, script)
    tab.wait_for_function("document.querySelectorAll('.fricmodels-figure .main-svg').length >= 6", timeout=30_000)
    assert tab.locator(".fricmodels-figure").count() == 6
    assert not said
    assert len(asked) == 1
    assert asked[0].startswith("https://cdn.plot.ly/plotly-")
    assert tab.title() == "cells"


def test_without_a_network_the_figures_say_so_and_the_tables_are_there(chromium: Any, shown: Path) -> None:
    tab, _, asked = opened(chromium, shown, None)
    tab.get_by_text("could not be loaded").first.wait_for(timeout=10_000)
    assert len(asked) == 1
    assert tab.get_by_text("could not be loaded").count() == 6
    assert tab.get_by_text("K_v", exact=True).first.is_visible()
