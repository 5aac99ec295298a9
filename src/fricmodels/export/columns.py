"""A leaderboard as a table: a few columns to read, or all of them for other programs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fricmodels.terminal import Column as Column

if TYPE_CHECKING:
    import pandas as pd

    from fricmodels.tournament.leaderboard import Leaderboard

Row = Mapping[str, Any]
_BANDS = "rms_torque_error_bands"
_NESTED = ("tags", "parameters", "standard_errors", "true_parameters", "not_identified", "no_interval", "settings")


_NAMES = {"held_out_rms_torque_error_percent": "test error", "rms_torque_error_percent": "fit error"}
NOT_SURE = {
    "?": "?: so many parameters are not determined, not converged, perhaps zero, or outside their bounds",
    "|": "|: so many parameters are at their bounds",
}
"""What the marks of a leaderboard mean."""


@dataclass(frozen=True)
class Titled:
    """A table with its title, and the window over which its errors are averaged, in words.

    ``medians`` says whether its rows are medians over seeds.
    """

    title: str
    columns: list[Column]
    window: str = ""
    medians: bool = False


def simulated_titles(rows: Sequence[Row]) -> tuple[tuple[str, str], ...]:
    """Return titles and keys of the simulated motion, where a tournament was ranked by it, in the unit of position."""
    motions = {"m" if "M" in row["parameters"] else "rad" for row in rows if row.get("simulated_position_error")}
    if not motions:
        return ()
    unit = motions.pop() if len(motions) == 1 else "rad or m"
    return (
        (f"simulated position {unit}", "simulated_position_error"),
        (f"simulated velocity {unit}/s", "simulated_velocity_error"),
    )


def concise(board: Leaderboard, *, dataset: bool = True) -> list[Column]:
    """Return the columns that are worth reading, as text; the status stands beside the model.

    Args:
        board: the leaderboard.
        dataset: whether the dataset is a column.
    """
    rows = board.rows
    columns = [Column("rank", tuple(str(row["rank"]) for row in rows), number=True)]
    columns += [Column(key, _texts(rows, key)) for key in ("model", "status", "estimator")]
    if dataset:
        columns.append(Column("dataset", _texts(rows, "dataset")))
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
            *simulated_titles(rows),
            (f"test error %{over}", "held_out_rms_torque_error_percent"),
            (f"fit error %{over}", "rms_torque_error_percent"),
            ("per sample %", "per_sample_percent"),
            ("tracking %", "tracking_error_percent"),
            ("seconds", "seconds"),
        )
        if any(cells := tuple(_figure(figures.get(key)) for figures in figured))
    ]
    marks = tuple(_marks(row) for row in rows)
    if any(marks):
        columns.append(Column("not sure of", marks))
    reasons = tuple("" if row["status"] == "ok" else " ".join(str(row["message"]).split()) for row in rows)
    if any(reasons):
        columns.append(Column("reason", reasons))
    return columns


def _marks(row: Row) -> str:
    """Return the parameters that are not identified, or at their bounds; see :data:`NOT_SURE`."""
    from fricmodels.parameter import at_bound
    from fricmodels.report.wording import declared

    if row["status"] != "ok":
        return ""
    loose = [f"{key}?" for key in row.get("not_identified") or ()]
    held = at_bound(declared(str(row["model"])), row["parameters"] or {})
    return " ".join([*loose, *(f"{key}|" for key in held if f"{key}?" not in loose)])


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


def summary(rows: Sequence[Row], *, dataset: bool = True) -> list[Column]:
    """Return the table of medians over seeds."""
    columns = [Column("rank", tuple(str(row["rank"]) for row in rows), number=True)]
    columns.append(Column("model", _texts(rows, "model")))
    columns.append(Column("ok", tuple(f"{row['ok']}/{row['seeds']}" for row in rows), number=True))
    columns += [Column(key, _texts(rows, key)) for key in ("estimator", "dataset")[: 1 + dataset]]
    for tag in dict.fromkeys(tag for row in rows for tag in row["tags"]):
        title = tag.replace("_percent", " %").replace("_", " ")
        columns.append(Column(title, tuple(_plain(row["tags"].get(tag)) for row in rows), number=True))
    columns.append(Column("median", tuple(_figure(row["median"]) for row in rows), number=True))
    ends = ((_figure(row["lower_quartile"]), _figure(row["upper_quartile"])) for row in rows)
    columns.append(Column("quartiles", tuple(f"{low} to {high}" if low else "" for low, high in ends), number=True))
    return columns


def tables(board: Leaderboard, top: int | None = None, rank_by: str | None = None) -> list[Titled]:
    """Return medians over seeds where there are several, then the fits; each dataset is ranked by itself.

    So is each condition of a dataset, such as a level of noise: the errors of two say nothing about the models.

    Args:
        board: the leaderboard.
        top: ranks of each dataset and condition; all if not given.
        rank_by: the column by which medians are ranked; the torque error if not given.
    """
    from fricmodels.tournament.leaderboard import Leaderboard

    several = len({row["tags"].get("seed") for row in board.rows}) > 1
    datasets = list(dict.fromkeys(str(row["dataset"]) for row in board.rows))
    medians = board.summary(rank_by) if several else []
    by = rank_by or board.figure
    figure = _NAMES.get(by, by.replace("_", " "))
    found = []
    for what in ("medians", "fits"):
        for name in datasets:
            on = f" on {name}" if len(datasets) > 1 else ""
            if what == "medians" and several:
                ranked = _by_condition([row for row in medians if row["dataset"] == name])
                title = f"Over seeds: {figure}{on}{_first(top, ranked)}"
                window = window_words(Leaderboard(tuple(row for row in board.rows if row["dataset"] == name)))
                found.append(Titled(title, summary(_best(ranked, top), dataset=not on), window, medians=True))
            elif what == "fits":
                own = _by_condition([row for row in board.rows if row["dataset"] == name])
                title = f"Leaderboard{on}{_first(top, own)}"
                shown = Leaderboard(tuple(_best(own, top)))
                found.append(Titled(title, concise(shown, dataset=not on), window_words(shown)))
    return found or [Titled("Leaderboard", concise(board))]


def _by_condition(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Return rows condition by condition (tags but the seed), each ranked by itself; within one in their order."""
    groups: dict[str, list[Row]] = {}
    for row in sorted(rows, key=lambda row: [_sorted(row["tags"][tag]) for tag in _condition(row)]):
        groups.setdefault(str({tag: row["tags"][tag] for tag in _condition(row)}), []).append(row)
    return [{**row, "rank": rank} for own in groups.values() for rank, row in enumerate(own, start=1)]


def _condition(row: Row) -> list[str]:
    return sorted(tag for tag in row["tags"] if tag != "seed")


def _sorted(value: Any) -> tuple[bool, float, str]:
    number = isinstance(value, int | float)
    return not number, float(value) if number else 0.0, str(value)


def _best(rows: Sequence[dict[str, Any]], top: int | None) -> list[dict[str, Any]]:
    return [row for row in rows if top is None or row["rank"] <= top]


def _first(top: int | None, rows: Sequence[dict[str, Any]]) -> str:
    shown = len(_best(rows, top))
    if top is None or shown == len(rows):
        return ""
    return f", the best {top} of {len(rows)}" if shown == top else f", the best {top} of each condition"


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
