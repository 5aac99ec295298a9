"""Keeps how the parameters of sequential estimators came about, for the report on a tournament."""

from __future__ import annotations

from pathlib import Path

from fricmodels.files import write_text
from fricmodels.results.history import FILE, SCHEMA, Histories, ParameterHistory
from fricmodels.tournament.jobs import HISTORY, Row


class Collected:
    """The best fit of every sequential estimator on each dataset, from kept rows in order of rank."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], ParameterHistory] = {}

    def add(self, row: Row) -> None:
        """Take a kept row into account, under the names that it has in its tournament."""
        content, place = row.get(HISTORY), (row["dataset"], row["estimator"])
        if content and row["status"] == "ok" and place not in self._found:
            named = {**content, "dataset": row["dataset"], "estimator": row["estimator"], "key": row["key"]}
            self._found[place] = ParameterHistory.model_validate(named, strict=False)

    def write(self, target: Path) -> None:
        """Write ``histories.json`` into the directory of a tournament; none where there is no history."""
        if self._found:
            write_text(target / FILE, Histories(schema_=SCHEMA, fits=tuple(self._found.values())).to_json())
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
