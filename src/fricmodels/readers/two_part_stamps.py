"""Time stamps in two columns, as ROS writes them: whole seconds, and nanoseconds within the second."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

_PARTS = (("secs", "nsecs"), ("sec", "nanosec"), ("sec", "nsec"), ("seconds", "nanoseconds"))


def with_whole_stamps(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with a column of seconds since the first row beside each pair of such columns.

    ``header.stamp.secs`` and ``header.stamp.nsecs`` make ``header.stamp``. Taken alone the one stands still for a
    second, and the other jumps back each second.
    """
    from pandas.api.types import is_numeric_dtype

    present = [str(name) for name in table.columns]
    for place, name in enumerate(present):
        for whole, part in _PARTS:
            stem = name.removesuffix(whole)
            called, beside = stem.rstrip("._/ ") or "stamp", stem + part
            if stem == name or beside not in present or called in present:
                continue
            if not all(is_numeric_dtype(table[one]) for one in (name, beside)):
                continue
            seconds = table[name].to_numpy(dtype=float)
            stamps = seconds - seconds[:1] + 1e-9 * table[beside].to_numpy(dtype=float)
            attributes = dict(table.attrs)
            table = table.copy(deep=False)
            table.insert(place, called, stamps)
            table.attrs = {**attributes, "units": {**attributes.get("units", {}), called: "s"}}
            return with_whole_stamps(table)
    return table
