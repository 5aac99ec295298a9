"""How results are looked at: as text where they are printed, as HTML in a notebook, and as tables."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar, Protocol

if TYPE_CHECKING:
    import pandas as pd


class Display(Protocol):
    """What makes tables, text and HTML of a result."""

    def tables(self, result: object, /) -> dict[str, pd.DataFrame]:
        """Return the tables of a result by title, the one that sums it up first."""

    def text(self, result: object, /) -> str:
        """Return a result as plain text."""

    def html(self, result: object, /) -> str:
        """Return a result as a piece of HTML."""


class Displayed:
    """A result that can be printed, shown in a notebook and turned into tables.

    Results know nothing of their looks: the package sets :attr:`display` to a function that imports the room which
    knows them, called when a result is first looked at.
    """

    __slots__ = ()
    display: ClassVar[Callable[[], Display]]

    def table(self) -> pd.DataFrame:
        """Return the table that sums the result up."""
        return next(iter(self.tables().values()))

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return every table of the result by title, the one that sums it up first."""
        return Displayed.display().tables(self)

    def __repr__(self) -> str:
        return Displayed.display().text(self)

    def _repr_html_(self) -> str:
        return Displayed.display().html(self)
