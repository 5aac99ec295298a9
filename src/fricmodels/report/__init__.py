"""Reports: one HTML file that says what was found, and figures for it, for notebooks and for documentation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fricmodels.report.page import Page


def write(page: Page, path: str | Path) -> Path:
    """Write a page as one HTML file, whole or not at all; its directory is made.

    Raises:
        InputError: when Plotly or Jinja2 is not installed, or the file cannot be written.
    """
    from fricmodels.report.render import render
    from fricmodels.tournament.files import write_text

    target = Path(path)
    html = render(page)
    target.parent.mkdir(parents=True, exist_ok=True)
    return write_text(target, html)


def of_run(directory: str | Path) -> Page:
    """Return the report on a folder that ``run``, ``diagnose`` or ``improve`` wrote, or on all of it.

    Raises:
        InputError: when there is neither ``leaderboard.json`` nor ``diagnosis.json``.
    """
    from fricmodels.report.folder import page

    return page(Path(directory))
