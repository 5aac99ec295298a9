"""The report in a real browser: it draws, it is quiet, it fits, it can be read by everybody, and names stay names."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

VIEWS = [(1280, "light"), (1280, "dark"), (400, "light"), (400, "dark")]
CHECKED = VIEWS[1:3]
PAGES = [("story_page", *view) for view in VIEWS] + [("tournament_page", *view) for view in CHECKED]


@pytest.mark.parametrize(("page", "width", "scheme"), PAGES)
def test_draws_everything_quietly_and_can_be_read_by_everybody(
    page: str, width: int, scheme: str, look: Callable[..., Any], axe: str, request: pytest.FixtureRequest
) -> None:
    """Text within figures, which axe cannot judge, is judged in tests/report."""
    seen = look(request.getfixturevalue(page), width, scheme)
    assert seen.draw_everything() > 5
    assert seen.page.evaluate("document.documentElement.scrollWidth") <= width
    assert seen.console == []
    assert seen.requests == []
    if (width, scheme) in CHECKED:
        seen.page.evaluate(axe)
        found = seen.page.evaluate("axe.run({exclude: [['.plot']]}, {resultTypes: ['violations']})")
        assert [(each["id"], each["nodes"][0]["html"]) for each in found["violations"]] == []
        assert any(each["id"] == "color-contrast" for each in found["passes"])


def test_figures_are_drawn_when_they_come_into_view(look: Callable[..., Any], tournament_page: Path) -> None:
    seen = look(tournament_page)
    places = seen.page.locator(".plot")
    assert places.count() > seen.page.locator(".plot[data-drawn]").count()
    assert seen.draw_everything() == seen.page.locator(".plot[data-drawn]").count()
    assert seen.page.locator(".plot svg.main-svg").count() >= places.count()


def test_the_button_changes_the_colours_of_page_and_figures(look: Callable[..., Any], story_page: Path) -> None:
    seen = look(story_page)
    seen.page.locator(".plot").first.scroll_into_view_if_needed()
    seen.page.locator(".plot[data-drawn]").first.wait_for()

    def colours() -> list[str]:
        return list(
            seen.page.evaluate(
                "[getComputedStyle(document.body).backgroundColor,"
                " getComputedStyle(document.querySelector('.plot .xtick text')).fill]"
            )
        )

    light = colours()
    button = seen.page.locator("#scheme")
    assert button.inner_text() == "Dark colours"
    button.click()
    dark = colours()
    assert all(a != b for a, b in zip(light, dark, strict=True))
    assert button.inner_text() == "Light colours"
    button.click()
    assert colours() == light


def test_the_keyboard_reaches_everything_in_reading_order(look: Callable[..., Any], tournament_page: Path) -> None:
    seen = look(tournament_page)
    stops = []
    for _ in range(12):
        seen.page.keyboard.press("Tab")
        stops.append(
            seen.page.evaluate(
                "[document.activeElement.textContent.trim().slice(0, 30),"
                " document.activeElement.getBoundingClientRect().top + scrollY]"
            )
        )
    assert stops[0][0] == "Skip to the report"
    assert stops[1][0] == "Dark colours"
    assert stops[2][0] == "Leaderboard"
    tops = [top for _, top in stops[1:]]
    assert tops == sorted(tops)
    seen.page.keyboard.press("Shift+Tab")
    seen = look(tournament_page)
    seen.page.keyboard.press("Tab")
    seen.page.keyboard.press("Enter")
    assert seen.page.evaluate("document.activeElement.id") == "content"


def test_without_scripts_the_words_and_tables_are_there(look: Callable[..., Any], story_page: Path) -> None:
    seen = look(story_page, java_script_enabled=False)
    text = seen.page.locator("main").inner_text()
    assert "cogging" in text
    assert seen.page.locator("noscript").count() == 1
    assert seen.page.locator("figcaption").count() == seen.page.locator(".plot").count()
    assert seen.page.locator("table").count() > 8


def test_hostile_names_stay_names(look: Callable[..., Any], hostile_pages: list[Path]) -> None:
    for path in hostile_pages:
        seen = look(path)
        assert seen.draw_everything() > 5
        assert seen.page.evaluate("window.hurt === undefined")
        assert seen.page.locator("img").count() == 0
        assert seen.console == []
        assert seen.requests == []
        assert "<script>window.hurt = 1</script>" in seen.page.locator("h1").inner_text()
        assert re.search(r"\$\{1\}.*\{\{7\*7\}\}", seen.page.title())


def test_the_picture_can_be_saved(look: Callable[..., Any], tournament_page: Path, tmp_path: Path) -> None:
    seen = look(tournament_page)
    seen.page.locator("[data-save]").first.wait_for()
    with seen.page.expect_download() as waiting:
        seen.page.locator("[data-save]").first.click()
    waiting.value.save_as(tmp_path / "figure.svg")
    assert "<svg" in (tmp_path / "figure.svg").read_text(encoding="utf-8")
