"""Keeps the results of a tournament as they come, in SQLite, by the hash of what decides them."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

from fricmodels.errors import FricmodelsError

FILE = "results.sqlite"


class Store:
    """Rows by job key. Whatever stops the program, the rows that were put are there afterwards.

    Where the power fails the last of them may be missing, and are done again; the file is whole in any case.

    Args:
        directory: where the file ``results.sqlite`` lies or is made.
    """

    def __init__(self, directory: str | Path) -> None:
        self.path = Path(directory) / FILE
        try:
            self._connection = sqlite3.connect(self.path, timeout=30.0)
            self._connection.execute("PRAGMA journal_mode=WAL")
            self._connection.execute("PRAGMA synchronous=NORMAL")  # no wait for the disk at every row
            self._connection.execute(
                "CREATE TABLE IF NOT EXISTS results (key TEXT PRIMARY KEY, status TEXT NOT NULL, row TEXT NOT NULL,"
                " finished TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP)"
            )
            self._connection.commit()
        except sqlite3.Error as error:
            raise FricmodelsError(f"{self.path}: cannot be used as a store of results: {error}") from None

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connection.close()

    def put(self, key: str, row: Mapping[str, Any]) -> None:
        """Keep a row; when this returns it is kept, however this program ends."""
        with self._connection:
            self._connection.execute(
                "INSERT OR REPLACE INTO results (key, status, row) VALUES (?, ?, ?)",
                (key, row["status"], json.dumps(row, allow_nan=False)),
            )

    def get(self, keys: Iterable[str]) -> dict[str, dict[str, Any]]:
        """Return the rows that are there, by key."""
        wanted = list(keys)
        found: dict[str, dict[str, Any]] = {}
        for start in range(0, len(wanted), 500):
            part = wanted[start : start + 500]
            marks = ",".join("?" * len(part))
            query = f"SELECT key, row FROM results WHERE key IN ({marks})"
            for key, text in self._connection.execute(query, part):
                row = _row(text)
                if row is not None:
                    found[key] = row
        return found

    def all_of(self, keys: Sequence[str]) -> list[dict[str, Any]]:
        """Return the rows of these keys, in their order.

        Raises:
            FricmodelsError: where one is not there.
        """
        found = self.get(keys)
        try:
            return [found[key] for key in keys]
        except KeyError:
            raise FricmodelsError(
                f"{self.path}: a result is gone that was put; give the same command again, it does what is missing"
            ) from None

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Within it, what is read does not change, whatever other programs put."""
        self._connection.execute("BEGIN")
        try:
            yield
        finally:
            self._connection.rollback()

    def rows(self) -> list[dict[str, Any]]:
        """Return all rows, those first that were put first."""
        texts = self._connection.execute("SELECT row FROM results ORDER BY finished, rowid")
        return [row for (text,) in texts if (row := _row(text)) is not None]

    def __len__(self) -> int:
        return int(self._connection.execute("SELECT COUNT(*) FROM results").fetchone()[0])


def _row(text: Any) -> dict[str, Any] | None:
    """Return a kept row, or ``None`` where it was spoilt since: its job is done again."""
    try:
        row = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        return None
    return row if isinstance(row, dict) and "status" in row else None
