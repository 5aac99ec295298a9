"""A test that hangs costs one failure with a name, not the whole run."""

import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
HANGS = """
import time

def test_before(): pass

def test_that_hangs(): time.sleep(60)

def test_after(): pass
"""


def test_one_that_hangs_is_ended_and_named_and_the_others_go_on(tmp_path: Path) -> None:
    (tmp_path / "test_hangs.py").write_text(HANGS)
    command = [sys.executable, "-m", "pytest", "-n", "1", "-c", str(PROJECT), "--rootdir", str(tmp_path)]
    options = ["-p", "no:cacheprovider", "-o", "faulthandler_timeout=2", "test_hangs.py"]
    ran = subprocess.run([*command, *options], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 1
    assert "crashed while running 'test_hangs.py::test_that_hangs'" in ran.stdout
    assert "1 failed, 2 passed" in ran.stdout
    assert "in test_that_hangs" in ran.stderr, "where it stood"
