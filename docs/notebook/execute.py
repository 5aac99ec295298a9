"""Executes the notebooks of the documentation, each in an empty directory, and keeps what they show."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient


def execute(page: Path) -> None:
    """Execute a notebook from its top and write it, with what each cell shows, in its place."""
    notebook = nbformat.read(page, as_version=4)
    with tempfile.TemporaryDirectory() as empty:
        # No times are recorded, so that a page changes only where its results do.
        NotebookClient(notebook, record_timing=False, resources={"metadata": {"path": empty}}).execute()
    notebook.metadata.pop("language_info", None)
    temporary = page.with_suffix(".tmp")
    nbformat.write(notebook, temporary)
    os.replace(temporary, page)


if __name__ == "__main__":
    for page in sorted(Path(__file__).parent.glob("*.ipynb")):
        execute(page)
