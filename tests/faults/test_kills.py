"""``kill -9`` at random moments, then the same command again: the results are those of an undisturbed one."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")


@pytest.fixture(scope="module")
def kills(from_benchmarks: Callable[[str], ModuleType]) -> ModuleType:
    return from_benchmarks("kills")


@pytest.mark.parametrize(
    ("name", "times"),
    [
        pytest.param("run", 1, marks=pytest.mark.long),  # a kill at each write: test_every_write.py
        pytest.param("run", 100, marks=pytest.mark.long),
        pytest.param("improve --out", 100, marks=pytest.mark.long),
    ],
)
def test_killed_and_done_again(name: str, times: int, kills: Any, tmp_path: Path) -> None:
    count = kills.killed(name, tmp_path, times, seed=1)
    assert count.kills == times
    assert count.ends >= 1
    assert count.faults == []
