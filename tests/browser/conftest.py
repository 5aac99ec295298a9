"""A headless Chromium, and pages to look at. Without the browser or its driver these tests are skipped, saying why."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path
from typing import Any, NoReturn

import pytest

from fricmodels.diagnosis import compare_model, kept_back, ready
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.report import of_run, story, write
from fricmodels.rig.demonstration import hidden
from fricmodels.tournament import run
from fricmodels.tournament.config import Config
from fricmodels.tournament.demonstration import MOTOR

DRAWN = "[...document.querySelectorAll('.plot')].every(place => place.dataset.drawn)"
HOSTILE = (
    """<script>window.hurt = 1</script>"onerror=window.hurt=1 </script>"""
    """<img src=x onerror='window.hurt = 1'> ${1} {{7*7}}"""
)
HOSTILE_NAME = """<script>window.hurt = 1<script>"<img src=x onerror='window.hurt = 1'> ${1} {{7*7}}"""
"""The same without a slash: a tournament's name is that of a folder."""


@dataclass
class Seen:
    """An open page, with what it said and asked for."""

    page: Any
    console: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def unfold(self) -> None:
        """Open all that is folded."""
        self.page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")

    def draw_everything(self) -> int:
        """Unfold everything, scroll to each figure, wait until it is drawn; return how many there are."""
        self.unfold()
        places = self.page.locator(".plot")
        for i in range(places.count()):
            places.nth(i).scroll_into_view_if_needed()
        for _ in range(200):
            if self.page.evaluate(DRAWN):
                return int(places.count())
            self.page.wait_for_timeout(50)
        raise AssertionError("a figure was not drawn within ten seconds")


Open = Callable[..., Seen]


@pytest.fixture
def look(chromium: Any) -> Iterator[Open]:
    """Open a file as a page of its own, from which no request may leave."""
    contexts = []

    def opened(path: Path, width: int = 1280, scheme: str = "light", **options: Any) -> Seen:
        context = chromium.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, **options)
        contexts.append(context)
        seen = Seen(context.new_page())
        seen.page.on("console", lambda message: seen.console.append(message.text))
        seen.page.on("pageerror", lambda error: seen.console.append(str(error)))

        def held(route: Any) -> None:
            url = route.request.url
            if url.startswith("file:"):
                route.continue_()
            else:
                seen.requests.append(url)
                route.abort()

        seen.page.route("**/*", held)
        seen.page.goto(path.as_uri())
        return seen

    yield opened
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def axe(without_browser: Callable[[str], NoReturn]) -> str:
    """Return the checker of accessibility as a program for a page."""
    try:
        return (resources.files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")
    except ImportError:
        without_browser("the checker of accessibility is not installed")


@pytest.fixture(scope="session")
def story_page(tmp_path_factory: pytest.TempPathFactory, demonstration: Any) -> Path:
    """Return the report on a drive with two hidden effects."""
    return write(story.of_ladder(demonstration.ladder), tmp_path_factory.mktemp("story") / "report.html")


def _tournament(folder: Path, name: str) -> Path:
    config = Config.model_validate(
        {
            "name": name,
            "datasets": [{"name": f"{name} one", "simulate": MOTOR}],
            "models": ["coulomb-viscous", "asymmetric-coulomb-viscous", "coulomb-viscous+thermal"],
            "estimators": ["rls", {"name": "constant-velocity", "label": f"{name} constant"}],
            "simulate": False,
        }
    )
    run(config, folder, executor="serial")
    return write(of_run(folder), folder / "report.html")


@pytest.fixture(scope="session")
def tournament_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the report on a small tournament, some fits of which fail."""
    return _tournament(tmp_path_factory.mktemp("tournament"), "motor")


@pytest.fixture(scope="session")
def hostile_pages(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Return reports in which every name that comes from a user would like to be a program."""
    folder = tmp_path_factory.mktemp("hostile")
    rig = hidden()
    recording = replace(rig.model_copy(update={"samples": 5_000}).simulate(), name=HOSTILE)
    train, test = kept_back(ready(recording))
    comparison = compare_model(train, test, Drive(Model.parse("coulomb-viscous"), rig.inertia, recording.motion))
    return [write(story.of_comparison(comparison), folder / "story.html"), _tournament(folder / "run", HOSTILE_NAME)]
