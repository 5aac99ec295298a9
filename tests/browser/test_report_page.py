"""The report in a real browser: it draws, it is quiet, it fits, it can be read by everybody, and names stay names."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

CHECKED = [(1280, "dark"), (400, "light")]
PAGES: list[Any] = [("tournament_page", 400, "light")]
OTHERS = [("story_page", 400, "light"), ("story_page", 1920, "light"), ("tournament_page", 1280, "dark")]
OTHERS += [("story_page", 1280, "light"), ("story_page", 400, "dark"), ("story_page", 1280, "dark")]
"""A page, a width and a scheme of which each was looked at in another view."""
PAGES += [pytest.param(*view, marks=pytest.mark.long) for view in OTHERS]


TWICE = "[...document.querySelectorAll('[id]')].map(e => e.id).filter((id, i, all) => all.indexOf(id) !== i)"
"""Names that two elements have."""
CUT = """[...document.querySelectorAll('.plot')].flatMap(place => {
  const box = place.getBoundingClientRect();
  const across = r => r.left < box.left - 1 || r.right > box.right + 1;
  const beyond = r => across(r) || r.top < box.top - 1 || r.bottom > box.bottom + 1;
  return [...place.querySelectorAll('svg text')]
    .filter(text => { const r = text.getBoundingClientRect(); return r.width > 0 && beyond(r); })
    .map(text => `${place.id}: ${text.textContent}`);
})"""
"""Texts that lie partly outside of their figure."""


@pytest.mark.parametrize(("page", "width", "scheme"), PAGES)
def test_draws_everything_quietly_and_can_be_read_by_everybody(
    page: str, width: int, scheme: str, look: Callable[..., Any], axe: str, request: pytest.FixtureRequest
) -> None:
    """Text within figures, which axe cannot judge, is judged in tests/report; so the page is judged before they are."""
    seen = look(request.getfixturevalue(page), width, scheme)
    if (width, scheme) in CHECKED:
        seen.unfold()
        seen.page.evaluate(axe)
        found = seen.page.evaluate("axe.run({exclude: [['.plot']]}, {resultTypes: ['violations']})")
        assert [(each["id"], each["nodes"][0]["html"]) for each in found["violations"]] == []
        assert any(each["id"] == "color-contrast" for each in found["passes"])
    assert seen.draw_everything() > 5
    assert seen.page.evaluate(TWICE) == []
    assert seen.page.evaluate("document.documentElement.scrollWidth") <= width
    assert seen.page.evaluate(CUT) == [], "a title, a label or a legend is cut"
    assert seen.console == []
    assert seen.requests == []


@pytest.mark.long
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


@pytest.mark.long
def test_the_keyboard_reaches_everything_in_reading_order(look: Callable[..., Any], tournament_page: Path) -> None:
    seen = look(tournament_page)
    stops = []
    for _ in range(12):
        seen.page.keyboard.press("Tab")
        stops.append(
            seen.page.evaluate(
                "[document.activeElement.textContent.trim().slice(0, 30),"
                " document.activeElement.getBoundingClientRect().top + scrollY,"
                " document.activeElement.closest('main') !== null]"
            )
        )
    assert stops[0][0] == "Skip to the report"
    assert stops[1][0] == "Dark colours"
    assert stops[2][0] == "Leaderboard"
    for inside in (False, True):  # the contents stand beside the report on a wide screen
        tops = [top for _, top, within in stops[1:] if within is inside]
        assert len(tops) > 2
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


@pytest.mark.long
def test_hostile_names_stay_names(look: Callable[..., Any], hostile_pages: list[Path]) -> None:
    names = ("<script>window.hurt = 1</script>", "<script>window.hurt = 1<script>")
    for path, name in zip(hostile_pages, names, strict=True):
        seen = look(path)
        assert seen.draw_everything() > 5
        assert seen.page.evaluate("window.hurt === undefined")
        assert seen.page.locator("img").count() == 0
        assert seen.console == []
        assert seen.requests == []
        assert name in seen.page.locator("h1").inner_text()
        assert re.search(r"\$\{1\}.*\{\{7\*7\}\}", seen.page.title())


@pytest.mark.long
def test_the_picture_can_be_saved(look: Callable[..., Any], tournament_page: Path, tmp_path: Path) -> None:
    seen = look(tournament_page)
    seen.page.locator("[data-save]").first.wait_for()
    with seen.page.expect_download() as waiting:
        seen.page.locator("[data-save]").first.click()
    waiting.value.save_as(tmp_path / "figure.svg")
    assert "<svg" in (tmp_path / "figure.svg").read_text(encoding="utf-8")


INK = """place => {
  const box = place.getBoundingClientRect();
  const svg = place.querySelector("svg.main-svg");
  const marks = svg ? svg.querySelectorAll("path, image, rect").length : 0;
  return {name: place.id, left: box.left, right: box.right, wide: svg ? svg.getBoundingClientRect().right : 0, marks};
}"""
A4_WIDTH = round((210 - 2 * 14) / 25.4 * 96)


@pytest.mark.long
def test_every_figure_prints_uncut(look: Callable[..., Any], story_page: Path) -> None:
    """What `beforeprint` leaves is what the printer gets: a PDF that is made at once is no exception."""
    seen = look(story_page, A4_WIDTH)
    seen.page.emulate_media(media="print")
    seen.page.evaluate("dispatchEvent(new Event('beforeprint'))")
    found = seen.page.evaluate(f"[...document.querySelectorAll('.plot')].map({INK})")
    assert len(found) > 15
    for each in found:
        assert each["marks"] > 10, f"{each['name']} is blank"
        assert each["wide"] <= A4_WIDTH + 1, f"{each['name']} is cut"
    tables = seen.page.evaluate(
        "[...document.querySelectorAll('main table')].map(e => e.getBoundingClientRect().right)"
    )
    assert max(tables) <= A4_WIDTH + 1
    rows = seen.page.evaluate(
        "[...document.querySelectorAll('#regimes .ytick text')].map(e => e.getBoundingClientRect().top)"
    )
    assert len(rows) > 10
    assert np.min(np.abs(np.diff(sorted(rows)))) > 12, "names beneath each other touch"
    seen.page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert seen.page.locator("main details[open]").count() == 0, "what was folded is folded again"
    assert seen.console == []


LEAST_FILLED = 0.6
"""Share of the height of a printed page down to which there is something, margins included; the last may be shorter."""


@pytest.mark.long
def test_a_pdf_has_every_figure_on_full_pages(
    look: Callable[..., Any], story_page: Path, tmp_path: Path, without_browser: Callable[[str], NoReturn]
) -> None:
    """Printed before anything was scrolled to, in the dark scheme: the pages are white and none is half empty."""
    pdftoppm = shutil.which("pdftoppm")
    seen = look(story_page, 1280, "dark")
    data = seen.page.pdf(format="A4", print_background=True, path=tmp_path / "report.pdf")
    pages = data.count(b"/Type /Page\n") or len(re.findall(rb"/Type\s*/Page\b(?!s)", data))
    assert 8 < pages < 26
    assert data.count(b"/Subtype /Image") + data.count(b"/Subtype/Image") >= 8, "maps are pictures"
    if pdftoppm is None:
        without_browser("there is no pdftoppm; install it with: apt-get install poppler-utils")
    subprocess.run([pdftoppm, "-r", "20", "-gray", tmp_path / "report.pdf", tmp_path / "page"], check=True)
    used = []
    for file in sorted(tmp_path.glob("page*.pgm")):
        content = file.read_bytes()
        width, height = (int(part) for part in content.split(maxsplit=3)[1:3])
        grey = np.frombuffer(content[-width * height :], dtype=np.uint8).reshape(height, width)
        assert np.median(grey) > 250, "paper is white"
        inked = np.flatnonzero((grey < 245).any(axis=1))
        used.append(float(inked[-1]) / height)
    assert len(used) == pages
    assert min(used[:-1]) > LEAST_FILLED, f"half-empty pages: {used}"


@pytest.mark.long
def test_a_long_formula_does_not_shrink_the_printed_page(
    look: Callable[..., Any], story_page: Path, tmp_path: Path, without_browser: Callable[[str], NoReturn]
) -> None:
    """A browser prints the whole page smaller where anything on it is wider than paper."""
    pdftotext = shutil.which("pdftotext")
    if pdftotext is None:
        without_browser("there is no pdftotext; install it with: apt-get install poppler-utils")
    sizes = []
    seen = look(story_page, 1280)
    without_figures = "document.querySelectorAll('script[id$=\"-data\"]').forEach(each => each.remove())"
    seen.page.evaluate(without_figures)  # they take long to draw, and are as wide as they are told
    for copies in (0, 3):
        seen.page.evaluate(
            "copies => { for (const each of document.querySelectorAll('.equations math')) { const own = each.innerHTML;"
            " for (let i = 0; i < copies; i++) each.insertAdjacentHTML('beforeend', own); } }",
            copies,
        )
        widest = "Math.max(...[...document.querySelectorAll('.equations math')].map(e => e.scrollWidth))"
        assert copies == 0 or seen.page.evaluate(widest) > 1.2 * A4_WIDTH
        seen.page.pdf(format="A4", path=tmp_path / "long.pdf")
        command = [str(pdftotext), "-l", "1", "-bbox", str(tmp_path / "long.pdf"), "-"]
        words = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        (place,) = re.findall(r'xMin="([0-9.]+)"[^>]*xMax="([0-9.]+)"[^>]*>report<', words)
        begin, end = map(float, place)
        sizes.append(end - begin)
    assert sizes[1] == pytest.approx(sizes[0], rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("page", ["story_page", "tournament_page"])
def test_the_page_is_short_and_small(page: str, look: Callable[..., Any], request: pytest.FixtureRequest) -> None:
    path = request.getfixturevalue(page)
    seen = look(path)
    assert seen.page.evaluate("document.documentElement.scrollHeight") <= 8000
    assert path.stat().st_size <= 3_000_000


def test_a_command_breaks_between_its_words_and_can_be_copied(look: Callable[..., Any], story_page: Path) -> None:
    seen = look(story_page, width=400)
    code = seen.page.locator(".verdict pre code")
    said = code.evaluate("code => code.textContent")
    tokens = seen.page.locator(".verdict pre .token")
    assert said.startswith("fricmodels ")
    assert tokens.all_text_contents() == said.split()
    lines = tokens.evaluate_all("all => all.map(each => each.getClientRects().length)")
    assert set(lines) == {1}, "each word is one box"
    wide = tokens.evaluate_all("all => all.map(each => each.getBoundingClientRect().right)")
    assert max(wide) <= code.evaluate("code => code.parentElement.getBoundingClientRect().right")


@pytest.mark.long
def test_zoomed_in_two_curves_lie_where_the_data_are(look: Callable[..., Any], story_page: Path) -> None:
    """In a window of a fiftieth of the record, the gap that is drawn between the curves is the residual below them."""
    seen = look(story_page)
    seen.page.locator("#over-time").scroll_into_view_if_needed()
    seen.page.locator("#over-time[data-drawn]").wait_for()
    worst = seen.page.evaluate(
        """() => {
          const place = document.getElementById("over-time"), layout = place._fullLayout;
          const [low, high] = layout.xaxis.range, middle = (low + high) / 2, half = (high - low) / 100;
          Plotly.relayout(place, {"xaxis.range": [middle - half, middle + half]});
          const [measured, modelled] = place._fullData, rest = place._fullData.find(each => each.name === "residual");
          let worst = 0, seen = 0;
          measured.x.forEach((x, i) => {
            if (Math.abs(x - middle) > half || measured.y[i] === null || isNaN(measured.y[i])) return;
            const gap = layout.yaxis.l2p(modelled.y[i]) - layout.yaxis.l2p(measured.y[i]);
            const said = layout.yaxis.l2p(0) - layout.yaxis.l2p(rest.y[i]);
            worst = Math.max(worst, Math.abs(gap - said), x === modelled.x[i] && x === rest.x[i] ? 0 : Infinity);
            seen += 1;
          });
          return seen > 5 ? worst : -1;
        }"""
    )
    assert 0 <= worst <= 1.0, "pixels, less than a line's width"


@pytest.mark.long
def test_figures_answer_to_the_keyboard_and_can_be_reset(look: Callable[..., Any], story_page: Path) -> None:
    seen = look(story_page)
    place = seen.page.locator(".plot").first
    place.scroll_into_view_if_needed()
    seen.page.locator(".plot[data-drawn]").first.wait_for()
    name = place.get_attribute("id")
    reset = seen.page.locator(f"[data-reset='{name}']")
    ends = f"document.getElementById('{name}')._fullLayout.xaxis.range.map(Number)"
    place.focus()
    assert seen.page.evaluate("document.activeElement.id") == name
    words = seen.page.evaluate(
        "document.getElementById(document.activeElement.getAttribute('aria-labelledby')).innerText"
    )
    assert len(words) > 40
    whole = seen.page.evaluate(ends)
    assert not reset.is_visible()
    seen.page.keyboard.press("+")
    closer = seen.page.evaluate(ends)
    assert closer[1] - closer[0] == pytest.approx(0.8 * (whole[1] - whole[0]))
    assert reset.is_visible()
    reset.click()
    assert seen.page.evaluate(ends) == pytest.approx(whole)
    assert not reset.is_visible()
