"""Makes distributions with an entry point, for as long as a test lasts."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fricmodels import plugins
from fricmodels.kernels.scan import cache_directory

Install = Callable[[str, str], Path]


@pytest.fixture
def another_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Take another cache for as long as a test lasts, with what is known already: compiled laws, tried plugins.

    Files are the same ones where the file system can; whoever writes one there puts another in its place.
    """
    known, cache = cache_directory(), tmp_path / "cache"

    def same(source: str, target: str) -> None:
        try:
            os.link(source, target)
        except FileNotFoundError:
            pass  # another process has just put another in its place
        except OSError:
            shutil.copy2(source, target)

    if known.is_dir():
        shutil.copytree(known, cache, copy_function=same)
    monkeypatch.setenv("FRICMODELS_CACHE", str(cache))
    return cache


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Return a function that installs a module of given source as the plugin ``name``; it returns the directory."""
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    modules: list[str] = []

    def make(name: str, source: str) -> Path:
        module = name.replace("-", "_")
        modules.append(module)
        (site / f"{module}.py").write_text(source, encoding="utf-8")
        information = site / f"{module}-1.0.dist-info"
        information.mkdir()
        (information / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (information / "entry_points.txt").write_text(f"[fricmodels]\n{name} = {module}\n")
        plugins.load.cache_clear()
        return site

    yield make
    for module in modules:
        sys.modules.pop(module, None)
    plugins.load.cache_clear()
