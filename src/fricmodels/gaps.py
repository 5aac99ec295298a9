"""The choice of what is done with rows that cannot be used; what it does is in :mod:`fricmodels.readers.gaps`."""

from __future__ import annotations

from enum import StrEnum


class Gaps(StrEnum):
    """Leave such rows out, or begin a new run after each of them; without either they are an error."""

    DROP = "drop"
    SPLIT = "split"
