"""Finds laws, effects, estimators and readers: the plugin manager, and nothing else, knows who provides them."""

from __future__ import annotations

from fricmodels.plugins.loading import load, unheard, versions
from fricmodels.plugins.registry import GROUP, Failure, LeftOut, Plugins, Registered, Registry

__all__ = ["GROUP", "Failure", "LeftOut", "Plugins", "Registered", "Registry", "load", "unheard", "versions"]
