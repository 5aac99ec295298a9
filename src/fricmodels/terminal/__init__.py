"""Tables and small plots for a terminal: readable without colour, and plain text when piped."""

from __future__ import annotations

from fricmodels.terminal.plots import Band, Marks, bar, show_plot
from fricmodels.terminal.records import breaks, show_records
from fricmodels.terminal.signs import spoken
from fricmodels.terminal.tables import Column, plain, show_table

__all__ = ["Band", "Column", "Marks", "bar", "breaks", "plain", "show_plot", "show_records", "show_table", "spoken"]
