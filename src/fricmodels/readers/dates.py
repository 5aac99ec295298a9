"""Stamps of loggers: ISO 8601, and dates with the day or the month first where it is certain which."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

_STAMP = (
    r"^\s*(?P<one>\d{1,2})(?P<mark>[./-])(?P<two>\d{1,2})(?P<again>[./-])(?P<year>\d{4}),?[\sT]\s*"
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?P<second>:\d{2}(?:[.,:]\d{1,9})?)?\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*$"
)
_ORDER = re.compile(r"\b(?:(d{1,2}|t{1,2})([./-])m{1,2}|m{1,2}([./-])(?:d{1,2}|t{1,2}))\b", re.IGNORECASE)
_MOST_MONTHS = 12


def states_order(column: str) -> bool | None:
    """Return whether the day comes first, as a column's name says (``dd/mm/yyyy``); ``None`` where it does not."""
    found = _ORDER.search(column)
    return None if found is None else found[1] is not None


def stamps(values: pd.Series, column: str) -> pd.Series | None:
    """Return date and time of each stamp; ``None`` where they are not written in one way that is certain.

    With points the day comes first, ``03.12.2025 13:59:50.004``, wherever dates are written so. With strokes or
    hyphens the day or the month may: a number above twelve tells, or the name of the column, or that all stamps are of
    one day, which then may be any.

    Args:
        values: texts.
        column: its name, which may state the order.
    """
    import pandas as pd

    iso = pd.to_datetime(values, errors="coerce", format="ISO8601")
    if iso.notna().all():
        return iso
    parts = values.str.extract(_STAMP)
    if parts["one"].isna().any() or (parts["mark"] != parts["again"]).any():
        return None
    first, second = parts["one"].astype(int), parts["two"].astype(int)
    day_first = _day_first(first, second, bool((parts["mark"] == ".").all()), column)
    if day_first is None:
        return None
    day, month = (first, second) if day_first else (second, first)
    dates = pd.to_datetime({"year": parts["year"].astype(int), "month": month, "day": day}, errors="coerce")
    clock = pd.to_timedelta(_clock(parts), errors="coerce")
    found = dates + clock
    return found if found.notna().all() else None


def _day_first(first: pd.Series, second: pd.Series, points: bool, column: str) -> bool | None:
    """Return whether the first number is the day, ``None`` where that cannot be told."""
    day_second = bool((second > _MOST_MONTHS).any())
    if (first > _MOST_MONTHS).any():
        return None if day_second else True
    if day_second:
        return None if points else False
    stated = states_order(column)
    if points or stated is not None:
        return points or stated
    one_day = first.nunique() == 1 and second.nunique() == 1
    return True if one_day else None


def _clock(parts: pd.DataFrame) -> pd.Series:
    """Return the times of the day as ``hours:minutes:seconds``."""
    hour = parts["hour"].astype(int)
    half = parts["half"].str[0].str.lower()
    hour = hour.where(half.isna(), hour % 12 + 12 * (half == "p"))
    hour = hour.where(hour < 24)  # a time of the day, and no duration
    second = parts["second"].fillna(":00").str.replace(r"^(:\d{2})[,:]", r"\1.", regex=True)
    return hour.map("{:.0f}".format) + ":" + parts["minute"] + second
