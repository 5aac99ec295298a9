"""The ranked result of a tournament, and its file ``leaderboard.json``."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from fricmodels.display import Displayed
from fricmodels.errors import InputError
from fricmodels.files import write_listed
from fricmodels.results.leaderboard import SCHEMA, LeaderboardDocument
from fricmodels.results.part import finite
from fricmodels.stored import read_results
from fricmodels.tournament.jobs import Row
from fricmodels.tournament.written_rows import WrittenRows

FILE = "leaderboard.json"
AGAIN = "fricmodels run CONFIG.yaml --out DIR"
HELD_OUT = "held_out_rms_torque_error_percent"
FITTED = "rms_torque_error_percent"
HELD = 5000
"""Rows of a leaderboard that a tournament holds in memory; beyond that they are read from its file."""


@dataclass(frozen=True, repr=False)
class Leaderboard(Displayed):
    """Rows in order of rank; those without a result come last, with their reason."""

    rows: Sequence[Row]

    @classmethod
    def written(cls, directory: str | Path, rows: Iterable[Row], count: int) -> Leaderboard:
        """Write ``leaderboard.json`` of rows that are ranked, as they come; return it as it stands there.

        Args:
            directory: where.
            rows: in order of rank.
            count: how many there are. Where they are more than 5 000 they are read from the file when they are asked
                for, so that memory does not grow with them.
        """
        path = Path(directory) / FILE
        kept = rows if count > HELD else tuple(rows)
        places = write_listed(path, {"schema": SCHEMA}, "rows", kept)
        return cls(kept if isinstance(kept, tuple) else WrittenRows(path, places))

    @classmethod
    def ranked(cls, rows: Iterable[Row], rank_by: str = HELD_OUT) -> Leaderboard:
        """Rank rows by a column, the smallest first, and number them from 1."""
        ordered = sorted(rows, key=lambda row: standing(row, rank_by))
        for place, row in enumerate(ordered):  # in the place of the one before, so that there are never two of each
            ordered[place] = {"rank": place + 1, **_without_rank(row)}
        return cls(tuple(ordered))

    @property
    def failures(self) -> tuple[Row, ...]:
        """Rows whose status is not ok."""
        return tuple(row for row in self.rows if row["status"] != "ok")

    @property
    def tags(self) -> tuple[str, ...]:
        """Names of all tags, in order of appearance."""
        return tuple(dict.fromkeys(tag for row in self.rows for tag in row["tags"]))

    @property
    def figure(self) -> str:
        """The torque error that there is: held out, or of what was fitted."""
        held_out = any(row[HELD_OUT] is not None for row in self.rows)
        return HELD_OUT if held_out or not self.rows else FITTED

    def summary(self, rank_by: str | None = None) -> list[Row]:
        """Summarise a column (the torque error) over seeds: median, quartiles, and how many ended well.

        A fit without a result counts as infinitely bad, so that failing on hard seeds is no advantage.
        """
        groups: dict[str, list[Row]] = {}
        for row in self.rows:
            tags = {tag: value for tag, value in row["tags"].items() if tag != "seed"}
            groups.setdefault(json.dumps([row["model"], row["estimator"], row["dataset"], tags]), []).append(row)
        listed = []
        for identity, rows in groups.items():
            model, estimator, dataset, tags = json.loads(identity)
            values = sorted(standing(row, rank_by or self.figure)[1] for row in rows)
            seconds = [row["seconds"] for row in rows if row["seconds"] is not None]
            listed.append(
                {
                    "model": model,
                    "estimator": estimator,
                    "dataset": dataset,
                    "tags": tags,
                    "seeds": len(rows),
                    "ok": sum(row["status"] == "ok" for row in rows),
                    "median": finite(median(values)),
                    "lower_quartile": finite(quantile(values, 0.25)),
                    "upper_quartile": finite(quantile(values, 0.75)),
                    "median_seconds": median(seconds) if seconds else None,
                }
            )
        listed.sort(key=lambda row: math.inf if row["median"] is None else row["median"])
        return [{"rank": rank, **row} for rank, row in enumerate(listed, start=1)]

    def write(self, directory: str | Path) -> Path:
        """Write ``leaderboard.json`` whole, or not at all."""
        write_listed(Path(directory) / FILE, {"schema": SCHEMA}, "rows", self.rows)
        return Path(directory) / FILE

    @classmethod
    def read(cls, run: str | Path) -> Leaderboard:
        """Read the leaderboard of a finished run, given its directory or the file itself.

        Raises:
            InputError: when there is none, or it is of another kind.
        """
        path = Path(run)
        path = path / FILE if path.is_dir() else path
        try:
            content = read_results(path, SCHEMA, AGAIN)
        except FileNotFoundError:
            raise InputError(f"{path}: there is no leaderboard; make one with: {AGAIN}") from None
        LeaderboardDocument.checked(content, path, AGAIN)
        return cls(tuple(content["rows"]))


def _without_rank(row: Row) -> Row:
    return {key: value for key, value in row.items() if key != "rank"}


def standing(row: Row, rank_by: str) -> tuple[bool, float]:
    """Return what decides the rank: whether there is no result, then the figure."""
    value = row.get(rank_by)
    bad = row["status"] != "ok" or value is None
    return bad, math.inf if bad or value is None else float(value)


def quantile(ordered: Sequence[float], fraction: float) -> float:
    """Return a quantile of sorted values, interpolated; infinite values stay infinite."""
    position = fraction * (len(ordered) - 1)
    below, above = math.floor(position), math.ceil(position)
    if ordered[below] == ordered[above]:
        return ordered[below]
    return ordered[below] + (position - below) * (ordered[above] - ordered[below])
