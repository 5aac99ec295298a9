"""``kill -9`` at random moments, then the same command again: the results are those of an undisturbed one."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")


@pytest.fixture(scope="module")
def kills() -> Any:
    spec = importlib.util.spec_from_file_location("kills_benchmark", ROOT / "benchmarks" / "kills.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("name", "times"),
    [
        ("run", 1),
        pytest.param("run", 100, marks=pytest.mark.long),
        pytest.param("improve --out", 100, marks=pytest.mark.long),
    ],
)
def test_killed_and_done_again(name: str, times: int, kills: Any, tmp_path: Path) -> None:
    count = kills.killed(name, tmp_path, times, seed=1)
    assert count.kills == times
    assert count.ends >= 1
    assert count.faults == []
