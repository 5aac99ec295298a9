"""A leaderboard as a table: a few columns to read, or all of them for other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fricmodels.terminal import Column as Column

if TYPE_CHECKING:
    import pandas as pd

    from fricmodels.tournament.leaderboard import Leaderboard

Row = Mapping[str, Any]
_NESTED = ("tags", "parameters", "standard_errors", "true_parameters", "not_identified", "settings")


def concise(board: Leaderboard) -> list[Column]:
    """Return the columns that are worth reading, as text."""
    rows = board.rows
    columns = [Column("rank", tuple(str(row["rank"]) for row in rows), number=True)]
    columns += [Column(key, _texts(rows, key)) for key in ("model", "estimator", "dataset")]
    columns += [
        Column(
            tag.replace("_percent", " %").replace("_", " "), tuple(_plain(row["tags"].get(tag)) for row in rows), True
        )
        for tag in board.tags
        if len({_plain(row["tags"].get(tag)) for row in rows}) > 1
    ]
    columns += [
        Column(title, cells, number=True)
        for title, key in (
            ("held-out error %", "held_out_rms_torque_error_percent"),
            ("fitted error %", "rms_torque_error_percent"),
            ("seconds", "seconds"),
        )
        if any(cells := tuple(_figure(row.get(key)) for row in rows))
    ]
    columns.append(Column("status", tuple(str(row["status"]) for row in rows)))
    reasons = tuple("" if row["status"] == "ok" else " ".join(str(row["message"]).split()) for row in rows)
    if any(reasons):
        columns.append(Column("reason", reasons))
    return columns


def summary(rows: Sequence[Row]) -> list[Column]:
    """Return the table of medians over seeds."""
    columns = [Column("rank", tuple(str(row["rank"]) for row in rows), number=True)]
    columns += [Column(key, _texts(rows, key)) for key in ("model", "estimator", "dataset")]
    for tag in dict.fromkeys(tag for row in rows for tag in row["tags"]):
        title = tag.replace("_percent", " %").replace("_", " ")
        columns.append(Column(title, tuple(_plain(row["tags"].get(tag)) for row in rows), number=True))
    for key in ("median", "lower_quartile", "upper_quartile"):
        columns.append(Column(key.replace("_", " "), tuple(_figure(row[key]) for row in rows), number=True))
    columns.append(Column("ok", tuple(f"{row['ok']}/{row['seeds']}" for row in rows), number=True))
    return columns


def tables(board: Leaderboard) -> list[list[Column]]:
    """Return the leaderboard, and the medians over seeds where there are several."""
    several = len({row["tags"].get("seed") for row in board.rows}) > 1
    return [concise(board), summary(board.summary())] if several else [concise(board)]


def frame(board: Leaderboard) -> pd.DataFrame:
    """Return everything, one column a value: ``tag.seed``, ``parameter.K_v``, ``standard_error.K_v``, …"""
    import pandas as pd

    flat = []
    for row in board.rows:
        values = {key: value for key, value in row.items() if key not in _NESTED}
        for key in _NESTED:
            single = key.removesuffix("s") if key != "settings" else "setting"
            values.update({f"{single}.{name}": value for name, value in (row.get(key) or {}).items()})
        flat.append(values)
    return pd.DataFrame(flat)


def _texts(rows: Sequence[Row], key: str) -> tuple[str, ...]:
    """Return cells of one line each."""
    return tuple(" ".join(str(row[key]).split()) for row in rows)


def _plain(value: Any) -> str:
    return "" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _figure(value: Any) -> str:
    return "" if value is None else f"{value:.3g}" if abs(value) < 1000 else f"{value:.4g}"
