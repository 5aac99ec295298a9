"""An environment of its own, in which everything of this one can be imported and more can be installed."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
import sysconfig
import venv
from dataclasses import dataclass
from pathlib import Path

import pytest


@dataclass(frozen=True)
class Environment:
    """A virtual environment on top of the one that runs the tests."""

    directory: Path

    def run(self, *command: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run ``python -m …`` there."""
        python = self.directory / ("Scripts" if sys.platform == "win32" else "bin") / "python"
        return subprocess.run([python, "-m", *command], capture_output=True, text=True, cwd=cwd, timeout=300)

    def install(self, *projects: Path) -> None:
        """Install projects in place, without a network."""
        options = ["--no-build-isolation", "--no-deps", "--quiet", "--disable-pip-version-check", "--no-index"]
        editable = [part for project in projects for part in ("-e", str(project))]
        done = self.run("pip", "install", *options, *editable)
        assert done.returncode == 0, done.stderr


@pytest.fixture(scope="session")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    """Return a fresh environment; its packages are those of this one."""
    if int(importlib.metadata.version("setuptools").split(".")[0]) < 77:
        pytest.skip("building without a network needs setuptools 77 or newer here: pip install 'fricmodels[dev]'")
    directory = tmp_path_factory.mktemp("environment")
    venv.create(directory, with_pip=False)
    (own,) = directory.glob("[Ll]ib/**/site-packages")
    (own / "beneath.pth").write_text(f"import site; site.addsitedir({sysconfig.get_path('purelib')!r})\n")
    return Environment(directory)
