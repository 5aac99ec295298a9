"""The code that makes a row of a leaderboard, as a hash: rows that other code made are not taken for this code's."""

from __future__ import annotations

import hashlib
import sys
from functools import lru_cache
from pathlib import Path

from fricmodels import plugins
from fricmodels.model import Model

_OWN = "fricmodels"
_ONLY_SHOW = {"cli", "diagnosis", "export", "notebook", "report", "scaffold", "terminal"}
"""Rooms of this package that decide nothing in a row."""


@lru_cache(maxsize=1024)
def code_of(estimator: str, *models: str) -> str:
    """Return a hash of the source of this distribution and of every plugin's that takes part.

    Args:
        estimator: its name.
        models: names of the model that is fitted, and of one that data are simulated with.

    Returns:
        The hash, or why a part of them is left out; see :class:`fricmodels.plugins.LeftOut`.
    """
    try:
        names = distributions(estimator, *models)
    except plugins.LeftOut as reason:
        return str(reason)
    parts = [digest(distribution) for distribution in sorted(names)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def distributions(estimator: str, *models: str) -> frozenset[str]:
    """Return the distributions that take part, this one among them.

    Raises:
        LeftOut: where a part is of a plugin that is broken; see :class:`fricmodels.plugins.LeftOut`.
    """
    registered = plugins.load()
    found = {_OWN, registered.estimators.entry(estimator).distribution}
    for model in map(Model.parse, models):
        found.add(registered.laws.entry(model.law.name).distribution)
        found |= {registered.effects.entry(effect.name).distribution for effect in model.effects}
    return frozenset(found)


@lru_cache(maxsize=64)
def digest(distribution: str) -> str:
    """Return a hash of the version of a distribution and of the source of the packages that it registers classes of."""
    entries = [registry.entry(name) for registry in plugins.load().registries.values() for name in registry]
    packages = {e.cls.__module__.partition(".")[0] for e in entries if e.distribution == distribution}
    content = hashlib.sha256(f"{distribution} {plugins.version_of(distribution) or ''}".encode())
    for package in sorted(packages):
        for name, file in _sources(package):
            content.update(name.encode() + file.read_bytes())
    return content.hexdigest()


def _sources(package: str) -> list[tuple[str, Path]]:
    """Return every file with source of a package, or the one of a module, and its name within."""
    module = sys.modules[package]
    folders = [Path(folder) for folder in getattr(module, "__path__", ())]
    if not folders:
        return [(package, Path(module.__file__))] if module.__file__ else []
    listed = [(file.relative_to(folder), file) for folder in folders for file in sorted(folder.rglob("*.py"))]
    left_out = _ONLY_SHOW if package == _OWN else set()
    return [(f"{package}/{path.as_posix()}", file) for path, file in listed if path.parts[0] not in left_out]
