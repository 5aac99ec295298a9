"""What an update of an exported estimator costs on a small processor: the benchmark's own figures, within budget."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "instructions.py"
TOOLS = ("arm-none-eabi-gcc", "qemu-system-arm")
MISSING = [tool for tool in TOOLS if shutil.which(tool) is None]


@pytest.mark.long
@pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}")
def test_updates_are_within_budget() -> None:
    done = subprocess.run([sys.executable, str(SCRIPT), "--json"], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-2000:]
    rows = json.loads(done.stdout)
    assert len(rows) == 6
    for row in rows:
        if "hardware" in row["processor"]:
            assert 100 < row["instructions"] <= row["budget"], row


@pytest.mark.long
@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_a_million_updates_in_c() -> None:
    """The time of an update does not grow, and every covariance stays positive definite."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT), "--updates", "1000000"], capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr[-2000:]
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(rows) == 6
    for row in rows:
        assert row["smallest_pivot"] > 0.0
        assert row["last_tenth"] < 3 * row["first_tenth"]
