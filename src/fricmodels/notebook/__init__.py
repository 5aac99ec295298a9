"""How results look in a notebook: tables as DataFrames, HTML with figures where Plotly is installed.

Every name is escaped: recordings, models and plugins are called what others have called them.
"""

from __future__ import annotations

from fricmodels.notebook.page import html, text
from fricmodels.notebook.tables import tables

__all__ = ["html", "tables", "text"]
