"""Reports: one HTML file that says what was found, and figures for it, for notebooks and for documentation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fricmodels.report.page import Page


def write(page: Page, path: str | Path) -> Path:
    """Write a page as one HTML file, whole or not at all.

    Raises:
        InputError: when Plotly or Jinja2 is not installed, or the file cannot be written.
    """
    from fricmodels.report.render import render
    from fricmodels.tournament.files import write_text

    return write_text(Path(path), render(page))
