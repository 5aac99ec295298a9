"""A leaderboard as a table: a few columns to read, or all of them for other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fricmodels.terminal import Column as Column

if TYPE_CHECKING:
    import pandas as pd

    from fricmodels.tournament.leaderboard import Leaderboard

Row = Mapping[str, Any]
_BANDS = "rms_torque_error_bands"
_NESTED = ("tags", "parameters", "standard_errors", "true_parameters", "not_identified", "no_interval", "settings")


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
    over = window_words(board)
    figured = [{**row, "per_sample_percent": _per_sample(row)} for row in rows]
    columns += [
        Column(title, cells, number=True)
        for title, key in (
            (f"test error %{over}", "held_out_rms_torque_error_percent"),
            (f"fit error %{over}", "rms_torque_error_percent"),
            ("per sample %", "per_sample_percent"),
            ("seconds", "seconds"),
        )
        if any(cells := tuple(_figure(figures.get(key)) for figures in figured))
    ]
    columns.append(Column("status", tuple(str(row["status"]) for row in rows)))
    reasons = tuple("" if row["status"] == "ok" else " ".join(str(row["message"]).split()) for row in rows)
    if any(reasons):
        columns.append(Column("reason", reasons))
    return columns


def window_words(board: Leaderboard) -> str:
    """Return over which window the torque errors are averaged, in words; nothing where rows differ in it."""
    windows = {row.get("rms_torque_error_band_ms") for row in board.rows if row["status"] == "ok"}
    only = windows.pop() if len(windows) == 1 else None
    return "" if only is None else f" over {only:.3g} ms"


def _per_sample(row: Row) -> float | None:
    """Return the torque error per sample in %, of what was kept back if there is any."""
    bands = row.get("rms_torque_error_bands")
    if not bands:
        return None
    held_out: float | None = bands[0]["held_out_percent"]
    return bands[0]["percent"] if held_out is None else held_out


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
    """Return everything, one column a value: ``tag.seed``, ``parameter.K_v``, ``per_sample.percent``, …"""
    import pandas as pd

    flat = []
    for row in board.rows:
        values = {key: value for key, value in row.items() if key not in (*_NESTED, _BANDS)}
        for band, figures in enumerate(row.get(_BANDS) or ()):
            name = f"{figures['window_ms']:.3g}_ms" if band else "per_sample"
            values.update({f"{name}.{key}": value for key, value in figures.items()})
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
