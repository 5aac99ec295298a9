"""Imports plugins, calls their hooks, and keeps what can be used."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, redirect_stdout
from functools import lru_cache, partial
from importlib.metadata import EntryPoint
from typing import Any, NamedTuple

import pluggy

from fricmodels import hookspecs
from fricmodels.errors import InputError
from fricmodels.plugins import probe
from fricmodels.plugins.exercise import exercise
from fricmodels.plugins.registry import GROUP, Failure, Plugins, Registered, Registry

_OWN = "fricmodels"
_DECISIVE = ("casadi", "numpy", "scipy", "llvmlite", "numba", "pandas", "filterpy")
_HOOKS = {
    "law": "fricmodels_laws",
    "effect": "fricmodels_effects",
    "estimator": "fricmodels_estimators",
    "reader": "fricmodels_readers",
    "controller": "fricmodels_controllers",
}
_BASES = {
    "law": "fricmodels.term.Law",
    "effect": "fricmodels.term.Effect",
    "estimator": "fricmodels.estimator.Estimator",
    "reader": "fricmodels.readers.base.Reader",
    "controller": "fricmodels.loop.Loop",
}
"""Base class of each kind; by name, as some of them stand above this room."""


@lru_cache(maxsize=1)
def load() -> Plugins:
    """Load every entry point of the group ``fricmodels``, once.

    A plugin that fails to import, or whose hook fails, is recorded as a :class:`Failure`; the rest goes on. One that
    would hang or kill the interpreter is not imported at all: it was found out in a process of its own, see
    :mod:`fricmodels.plugins.probe`.
    """
    manager = _manager()
    failures: list[Failure] = []
    found: dict[str, dict[str, Registered[object]]] = {kind: {} for kind in _HOOKS}
    points = sorted(importlib.metadata.entry_points(group=GROUP), key=_built_in_first)
    if probe.under_way():
        points = [point for point in points if _is_built_in(point)]
    verdicts = probe.verdicts([point for point in points if not _is_built_in(point)])
    dangers: dict[tuple[str, str], str] = {}
    unsafe: list[Failure] = []
    for point in points:
        distribution = _distribution(point)
        verdict = verdicts.get((distribution, point.name), probe.Verdict())
        reason = verdict.reason or None
        offers, problems = offered(point, manager) if reason is None else ([], [Problem(reason)])
        for kind, cls in offers:
            reason = _registered(found[kind], kind, cls, distribution)
            if reason is not None:
                problems.append(Problem(reason, (kind, cls.name)))
        names = [(kind, cls.name) for kind, cls in offers]
        for kind, name, why in verdict.dangers:
            if (kind, name) in names and found[kind][name].distribution == distribution:
                dangers[kind, name] = why
                unsafe.append(Failure(point.name, distribution, f"{kind} '{name}': {why}", (kind, name)))
        lost = () if _is_built_in(point) else probe.lost(point, names, whole=not problems)
        failures.extend(Failure(point.name, distribution, p.reason, p.concerns, lost) for p in problems)
    kept = tuple(failures)
    return Plugins(
        laws=Registry("law", found["law"], kept, dangers),  # type: ignore[arg-type]
        effects=Registry("effect", found["effect"], kept, dangers),  # type: ignore[arg-type]
        estimators=Registry("estimator", found["estimator"], kept),
        readers=Registry("reader", found["reader"], kept),
        controllers=Registry("controller", found["controller"], kept),
        failures=kept,
        unsafe=tuple(unsafe),
    )


def versions() -> dict[str, str]:
    """Return the versions of what takes part in a result: Python, this package, what it computes with, plugins."""
    registries = load().registries.values()
    distributions = {registry.entry(name).distribution for registry in registries for name in registry.names}
    found = {"python": platform.python_version()}
    for name in (_OWN, *_DECISIVE, *sorted(distributions - {_OWN})):
        if (version := version_of(name)) is not None:
            found[name] = version
    return found


def version_of(distribution: str) -> str | None:
    """Return the version of a distribution, or ``None`` for the name of a module that no distribution brought."""
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return None


class Problem(NamedTuple):
    """Why something cannot be used, and the kind and name of the class where it is one class."""

    reason: str
    concerns: tuple[str, str] | None = None


@contextmanager
def unheard() -> Iterator[None]:
    """Keep what a plugin prints away from standard output, which holds results."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
        yield


@unheard()
def offered(point: EntryPoint, manager: pluggy.PluginManager) -> tuple[list[tuple[str, type[Any]]], list[Problem]]:
    """Import a plugin and call its hooks; return kind and class of what can be used, and what is wrong besides."""
    try:
        module = point.load()
        manager.register(module, name=f"{_distribution(point)}:{point.name}")
    except (Exception, SystemExit) as error:
        return [], [Problem(f"{type(error).__name__}: {error}")]
    written_for = getattr(module, "fricmodels_interface", hookspecs.INTERFACE)
    if written_for != hookspecs.INTERFACE:
        newer = isinstance(written_for, int) and written_for > hookspecs.INTERFACE
        way = "update fricmodels" if newer else "update the plugin"
        return [], [Problem(f"it is for plugin interface {written_for!r}, this is {hookspecs.INTERFACE}; {way}")]
    offers: list[tuple[str, type[Any]]] = []
    problems: list[Problem] = []
    for kind, hook in _HOOKS.items():
        implementation = getattr(module, hook, None)
        if implementation is None:
            continue
        try:
            classes = list(implementation())
        except (Exception, SystemExit) as error:
            problems.append(Problem(f"{hook}: {type(error).__name__}: {error}"))
            continue
        for cls in classes:
            reason = _unusable(kind, cls) or (None if _is_built_in(point) else _unmakeable(kind, cls))
            if reason is None:
                offers.append((kind, cls))
            else:
                problems.append(Problem(reason, (kind, str(getattr(cls, "name", "")))))
    return offers, problems


def survive(name: str, value: str, skip: Collection[tuple[str, str]], doing: Callable[[str, str, str], None]) -> None:
    """Do in a process of its own what loading and using a plugin does, whatever becomes of it.

    Args:
        name, value: of its entry point.
        skip: kind and name of what is not used.
        doing: is told kind and name of what is used next, and which method.
    """
    offers, _ = offered(EntryPoint(name, value, GROUP), _manager())
    for kind, cls in offers:
        if (kind, cls.name) not in skip:
            exercise(kind, cls, partial(doing, kind, cls.name))


def _manager() -> pluggy.PluginManager:
    manager = pluggy.PluginManager(GROUP)
    manager.add_hookspecs(hookspecs)
    return manager


def _distribution(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else "unknown"


def _is_built_in(point: EntryPoint) -> bool:
    return _distribution(point) == _OWN


def _built_in_first(point: EntryPoint) -> tuple[bool, str, str]:
    return (not _is_built_in(point), _distribution(point), point.name)


def _registered(entries: dict[str, Registered[object]], kind: str, cls: type[Any], distribution: str) -> str | None:
    """Register a class, or return why its name cannot be had."""
    if cls.name in entries:
        return f"{kind} '{cls.name}' is already provided by {entries[cls.name].distribution}"
    entries[cls.name] = Registered(cls, distribution)
    return None


def _unusable(kind: str, cls: type[Any]) -> str | None:
    """Return what keeps a class from being listed and used, or ``None``."""
    name = getattr(cls, "name", None)
    if not isinstance(name, str):
        return f"{cls!r} is a {kind} without a name"
    abstract: frozenset[str] = getattr(cls, "__abstractmethods__", frozenset())
    if abstract:
        return f"{kind} '{name}' does not write {', '.join(sorted(abstract))}"
    if _BASES[kind] not in {f"{base.__module__}.{base.__qualname__}" for base in getattr(cls, "__mro__", ())}:
        return f"{kind} '{name}' is not derived from {_BASES[kind]}"
    for declared in (*getattr(cls, "parameters", ()), *getattr(cls, "states", ())):
        try:
            _ = declared.dimension
        except (InputError, ValueError, ArithmeticError) as error:
            return f"{kind} '{name}' declares {declared.symbol}: {error}"
    return None


def _unmakeable(kind: str, cls: type[Any]) -> str | None:
    """Return why a class cannot be made without arguments, as every command makes it, or ``None``."""
    try:
        cls()
    except (Exception, SystemExit) as error:
        return f"{kind} '{cls.name}' cannot be made: {type(error).__name__}: {error}"
    return None
