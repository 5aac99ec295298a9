"""The choice of what is done with rows that cannot be used; what it does is in :mod:`fricmodels.readers.gaps`."""

from __future__ import annotations

from enum import StrEnum


class Gaps(StrEnum):
    """Leave such rows out, begin a new run after each of them, or join channels that stand in rows of their own.

    Without any of them such a row is an error.
    """

    DROP = "drop"
    SPLIT = "split"
    JOIN = "join"
