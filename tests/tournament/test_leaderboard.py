"""Ranking, failures last, medians over seeds, and the file."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.errors import InputError
from fricmodels.tournament.leaderboard import Leaderboard


def row(
    error: float | None, status: str = "ok", seed: int = 0, model: str = "m", seconds: float = 0.1
) -> dict[str, Any]:
    return {
        "model": model,
        "estimator": "e",
        "dataset": "d",
        "tags": {"noise_percent": 5, "seed": seed},
        "rms_torque_error_percent": error,
        "held_out_rms_torque_error_percent": error,
        "parameters": {"K_v": 1.0},
        "standard_errors": {"K_v": 0.1},
        "true_parameters": None,
        "seconds": seconds,
        "status": status,
        "message": "" if status == "ok" else "why",
    }


@given(st.lists(st.tuples(st.floats(0, 1e6), st.booleans()), min_size=1, max_size=20))
def test_rank_rises_with_the_error_and_failures_come_last(cases: list[tuple[float, bool]]) -> None:
    board = Leaderboard.ranked(row(error, "ok" if good else "failed") for error, good in cases)
    assert [r["rank"] for r in board.rows] == list(range(1, len(cases) + 1))
    good = [r["held_out_rms_torque_error_percent"] for r in board.rows if r["status"] == "ok"]
    assert good == sorted(good)
    assert all(r["status"] == "ok" for r in board.rows[: len(good)])


def test_another_column_decides() -> None:
    board = Leaderboard.ranked([row(1.0, seconds=9.0, model="slow"), row(2.0, seconds=1.0, model="quick")], "seconds")
    assert [r["model"] for r in board.rows] == ["quick", "slow"]


def test_median_and_quartiles_over_seeds() -> None:
    rows = [row(float(value), seed=value) for value in range(1, 6)]
    rows += [row(2.5, seed=seed, model="n") for seed in range(4)] + [row(None, "diverged", seed=4, model="n")]
    first, second = Leaderboard.ranked(rows).summary()
    assert (first["model"], first["median"], first["ok"], first["seeds"]) == ("n", 2.5, 4, 5)
    assert (second["median"], second["lower_quartile"], second["upper_quartile"]) == (3.0, 2.0, 4.0)


def test_failing_on_most_seeds_is_no_advantage() -> None:
    rows = [row(0.1, seed=0, model="fragile")] + [row(None, "failed", seed=s, model="fragile") for s in (1, 2)]
    rows += [row(5.0, seed=s, model="sturdy") for s in range(3)]
    summary = Leaderboard.ranked(rows).summary()
    assert [s["model"] for s in summary] == ["sturdy", "fragile"]
    assert summary[1]["median"] is None


def test_file_has_the_schema_and_comes_back(tmp_path: Path) -> None:
    board = Leaderboard.ranked([row(2.0), row(None, "timeout")])
    path = board.write(tmp_path)
    content = json.loads(path.read_text())
    assert content["schema"] == "fricmodels/leaderboard/1"
    assert set(content) == {"schema", "rows"}
    assert list(content["rows"][0])[:14] == [
        "rank", "model", "estimator", "dataset", "tags", "rms_torque_error_percent",
        "held_out_rms_torque_error_percent", "parameters", "standard_errors", "true_parameters", "seconds",
        "status", "message",
    ][:14]  # fmt: skip
    assert Leaderboard.read(tmp_path) == board == Leaderboard.read(path)
    assert [p.name for p in tmp_path.iterdir()] == ["leaderboard.json"]


def test_numbers_that_json_cannot_hold_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError):
        Leaderboard.ranked([row(math.nan)]).write(tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"schema": "other/1", "rows": []}', "\x00"])
def test_what_is_no_leaderboard(tmp_path: Path, text: str) -> None:
    (tmp_path / "leaderboard.json").write_text(text)
    with pytest.raises(InputError):
        Leaderboard.read(tmp_path)
    with pytest.raises(InputError, match="there is no leaderboard"):
        Leaderboard.read(tmp_path / "nowhere")
