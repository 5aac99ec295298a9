"""Finds laws, effects, estimators, readers, controllers: the plugin manager, and nothing else, knows whose they are."""

from __future__ import annotations

from fricmodels.plugins.loading import load, unheard, version_of, versions
from fricmodels.plugins.registry import GROUP, Failure, LeftOut, Plugins, Registered, Registry

__all__ = [
    "GROUP",
    "Failure",
    "LeftOut",
    "Plugins",
    "Registered",
    "Registry",
    "load",
    "unheard",
    "version_of",
    "versions",
]
