"""Reports: one HTML file that says what was found, and figures for it, for notebooks and for documentation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fricmodels.report.page import Page


def check(path: str | Path) -> None:
    """Make sure, before the work begins, that a report can be written there.

    Raises:
        InputError: when Plotly or Jinja2 is not installed, or there is no such place.
    """
    from importlib.util import find_spec

    from fricmodels.errors import InputError

    for needed in ("plotly", "jinja2"):
        if find_spec(needed) is None:
            raise InputError(
                f"reports need {needed}, which is not installed; install it with: pip install 'fricmodels[report]'"
            )
    target = Path(path)
    if target.is_dir():
        raise InputError(f"{target}: is a directory; name a file in it, such as {target / 'report.html'}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{target}: cannot be written: {error.strerror}") from None


def write(page: Page, path: str | Path) -> Path:
    """Write a page as one HTML file, whole or not at all; its directory is made.

    Raises:
        InputError: when Plotly or Jinja2 is not installed, or the file cannot be written.
    """
    from fricmodels.files import write_text
    from fricmodels.report.render import render

    check(path)
    return write_text(Path(path), render(page))


def files_of_run(directory: str | Path) -> list[Path]:
    """Return the files that :func:`of_run` reads: those of the folder, and the recordings that they are of."""
    from fricmodels.report.folder import files

    return files(Path(directory))


def of_run(directory: str | Path) -> Page:
    """Return the report on a folder that ``run``, ``diagnose`` or ``improve`` wrote, or on all of it.

    Raises:
        InputError: when there is neither ``leaderboard.json`` nor ``diagnosis.json``.
    """
    from fricmodels.report.folder import page

    return page(Path(directory))
