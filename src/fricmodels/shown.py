"""How results show themselves in a notebook."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


class Shown:
    """A result that shows itself: HTML in a notebook, text where it is printed, and its figures as tables.

    What it looks like is decided in :mod:`fricmodels.notebook`, which knows every kind of result and is imported when
    one is first shown; results know nothing of their looks.
    """

    __slots__ = ()

    def table(self) -> pd.DataFrame:
        """Return the table that sums the result up."""
        tables = self.tables()
        return tables[next(iter(tables))]

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return every table of the result by title, the one that sums it up first."""
        tables: dict[str, pd.DataFrame] = _notebook().tables(self)
        return tables

    def __repr__(self) -> str:
        return str(_notebook().text(self))

    def _repr_html_(self) -> str:
        return str(_notebook().html(self))


def _notebook() -> Any:
    return importlib.import_module("fricmodels.notebook")
