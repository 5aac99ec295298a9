"""Keeps how the parameters of sequential estimators came about, for the report on a tournament."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fricmodels.files import write_text
from fricmodels.results.history import FILE, SCHEMA, Histories, ParameterHistory
from fricmodels.tournament.jobs import HISTORY, Row
from fricmodels.tournament.leaderboard import Leaderboard


def write_histories(target: Path, board: Leaderboard, rows: Mapping[str, Row]) -> None:
    """Write ``histories.json``: of each dataset the best fit of every sequential estimator; none where there is none.

    Args:
        target: directory of the tournament.
        board: its leaderboard.
        rows: all kept rows, by key.
    """
    found: dict[tuple[str, str], ParameterHistory] = {}
    for row in board.rows:
        content = rows[row["key"]].get(HISTORY)
        place = (row["dataset"], row["estimator"])
        if content and row["status"] == "ok" and place not in found:
            named = {**content, "dataset": row["dataset"], "estimator": row["estimator"], "key": row["key"]}
            found[place] = ParameterHistory.model_validate(named, strict=False)
    if found:
        write_text(target / FILE, Histories(schema_=SCHEMA, fits=tuple(found.values())).to_json())
    else:
        (target / FILE).unlink(missing_ok=True)


def read_histories(directory: Path) -> dict[tuple[str, str], ParameterHistory]:
    """Return the histories of a tournament by dataset and estimator; none where it kept none.

    Raises:
        InputError: when the file is there and cannot be read.
    """
    if not (directory / FILE).exists():
        return {}
    fits = Histories.read(directory / FILE, "fricmodels run CONFIG.yaml --out DIR").fits
    return {(fit.dataset, fit.estimator): fit for fit in fits}
