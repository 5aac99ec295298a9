"""Results are kept as they come and survive what stops the program."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from fricmodels.errors import FricmodelsError
from fricmodels.tournament.store import Store


def test_rows_come_back_by_key(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        for number in range(600):
            store.put(f"key{number}", {"status": "ok", "number": number})
        store.put("key7", {"status": "failed", "number": -7})
        assert len(store) == 600
    with Store(tmp_path) as store:
        found = store.get([f"key{number}" for number in range(700)])
    assert len(found) == 600
    assert found["key7"] == {"status": "failed", "number": -7}
    assert found["key599"]["number"] == 599


def test_a_row_is_on_disk_when_put_returns(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.put("a", {"status": "ok"})
    with sqlite3.connect(store.path) as other:
        assert other.execute("SELECT key FROM results").fetchall() == [("a",)]
    other.close()
    store.__exit__(None, None, None)


def test_not_finite_numbers_are_refused(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        with pytest.raises(ValueError):
            store.put("a", {"status": "ok", "value": float("nan")})
        assert len(store) == 0


def test_a_file_that_is_no_store(tmp_path: Path) -> None:
    (tmp_path / "results.sqlite").write_text("this is no data base, but a text that is long enough to be one\n" * 9)
    with pytest.raises(FricmodelsError, match="cannot be used as a store"):
        Store(tmp_path)
