"""Leaderboards for other programs and for people: table, Markdown, CSV, JSON, Parquet, HTML, LaTeX."""

from __future__ import annotations

from fricmodels.export.columns import Column, concise, frame, tables
from fricmodels.export.formats import FORMATS, export

__all__ = ["FORMATS", "Column", "concise", "export", "frame", "tables"]
