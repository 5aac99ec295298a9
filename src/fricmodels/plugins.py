"""Finds laws, effects, estimators and readers: the plugin manager, and nothing else, knows who provides them."""

from __future__ import annotations

import importlib
import importlib.metadata
import platform
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import pluggy

from fricmodels import hookspecs
from fricmodels.errors import InputError, suggestion

if TYPE_CHECKING:
    from fricmodels.estimator import Estimator
    from fricmodels.readers.base import Reader
    from fricmodels.term import Effect, Law

GROUP = "fricmodels"
T = TypeVar("T")


@dataclass(frozen=True)
class Failure:
    """A plugin that could not be used, and why."""

    plugin: str
    distribution: str
    reason: str

    def __str__(self) -> str:
        return f"plugin '{self.plugin}' of {self.distribution} is left out: {self.reason}"


@dataclass(frozen=True)
class Registered(Generic[T]):
    """A registered class and the distribution that it came from."""

    cls: type[T]
    distribution: str


class Registry(Generic[T]):
    """The classes of one kind, by name."""

    def __init__(self, kind: str, entries: dict[str, Registered[T]]) -> None:
        self.kind = kind
        self._entries = entries

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def __len__(self) -> int:
        return len(self._entries)

    def entry(self, name: str) -> Registered[T]:
        """Return the class and its origin.

        Raises:
            InputError: naming the nearest known name.
        """
        try:
            return self._entries[name]
        except KeyError:
            raise InputError(f"unknown {self.kind} '{name}'{suggestion(name, self._entries)}") from None

    def __getitem__(self, name: str) -> type[T]:
        return self.entry(name).cls


@dataclass(frozen=True)
class Plugins:
    """All that is registered, and what failed to register."""

    laws: Registry[Law]
    effects: Registry[Effect]
    estimators: Registry[Estimator]
    readers: Registry[Reader]
    failures: tuple[Failure, ...]

    @property
    def registries(self) -> dict[str, Registry[Any]]:
        """The registry of each kind: ``law``, ``effect``, ``estimator``, ``reader``."""
        return {"law": self.laws, "effect": self.effects, "estimator": self.estimators, "reader": self.readers}


_DECISIVE = ("casadi", "numpy", "scipy", "numba", "pandas", "filterpy")


def versions() -> dict[str, str]:
    """Return the versions of what takes part in a result: Python, this package, what it computes with, plugins."""
    registries = load().registries.values()
    distributions = {registry.entry(name).distribution for registry in registries for name in registry}
    found = {"python": platform.python_version()}
    for name in ("fricmodels", *_DECISIVE, *sorted(distributions - {"fricmodels"})):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue  # a module that no distribution brought
    return found


_HOOKS = {
    "law": "fricmodels_laws",
    "effect": "fricmodels_effects",
    "estimator": "fricmodels_estimators",
    "reader": "fricmodels_readers",
}

_BASES = {
    "law": ("fricmodels.term", "Law"),
    "effect": ("fricmodels.term", "Effect"),
    "estimator": ("fricmodels.estimator", "Estimator"),
    "reader": ("fricmodels.readers.base", "Reader"),
}


@lru_cache(maxsize=1)
def load() -> Plugins:
    """Load every entry point of the group ``fricmodels``, once.

    A plugin that fails to import, or whose hook fails, is recorded as a :class:`Failure`; the rest goes on.
    """
    manager = pluggy.PluginManager(GROUP)
    manager.add_hookspecs(hookspecs)
    failures: list[Failure] = []
    origins: dict[str, str] = {}
    points = sorted(importlib.metadata.entry_points(group=GROUP), key=_built_in_first)
    for point in points:
        distribution = point.dist.name if point.dist is not None else "unknown"
        try:
            module = point.load()
            manager.register(module, name=f"{distribution}:{point.name}")
        except (Exception, SystemExit) as error:
            failures.append(Failure(point.name, distribution, f"{type(error).__name__}: {error}"))
        else:
            origins[f"{distribution}:{point.name}"] = distribution
    found: dict[str, dict[str, Registered[object]]] = {kind: {} for kind in _HOOKS}
    for plugin_name, distribution in origins.items():
        module = manager.get_plugin(plugin_name)
        for kind, hook in _HOOKS.items():
            implementation = getattr(module, hook, None)
            if implementation is None:
                continue
            try:
                classes = list(implementation())
            except (Exception, SystemExit) as error:
                failures.append(Failure(plugin_name, distribution, f"{hook}: {type(error).__name__}: {error}"))
                continue
            for cls in classes:
                problem = _register(found[kind], kind, cls, distribution)
                if problem:
                    failures.append(Failure(plugin_name, distribution, problem))
    return Plugins(
        laws=Registry("law", found["law"]),  # type: ignore[arg-type]
        effects=Registry("effect", found["effect"]),  # type: ignore[arg-type]
        estimators=Registry("estimator", found["estimator"]),  # type: ignore[arg-type]
        readers=Registry("reader", found["reader"]),  # type: ignore[arg-type]
        failures=tuple(failures),
    )


def _built_in_first(point: importlib.metadata.EntryPoint) -> tuple[bool, str, str]:
    name = point.dist.name if point.dist is not None else ""
    return (name != "fricmodels", name, point.name)


def _register(entries: dict[str, Registered[object]], kind: str, cls: type[object], distribution: str) -> str | None:
    name = getattr(cls, "name", None)
    if not isinstance(name, str):
        return f"{cls!r} is a {kind} without a name"
    abstract: frozenset[str] = getattr(cls, "__abstractmethods__", frozenset())
    if abstract:
        return f"{kind} '{name}' does not write {', '.join(sorted(abstract))}"
    if name in entries:
        return f"{kind} '{name}' is already provided by {entries[name].distribution}"
    problem = _problem(kind, cls)
    if problem:
        return f"{kind} '{name}' {problem}"
    entries[name] = Registered(cls, distribution)
    return None


def _problem(kind: str, cls: type[Any]) -> str | None:
    """Return what keeps a class from being listed and used, or ``None``."""
    home, base = _BASES[kind]
    if not (isinstance(cls, type) and issubclass(cls, getattr(importlib.import_module(home), base))):
        return f"is not derived from {home}.{base}"
    for declared in (*getattr(cls, "parameters", ()), *getattr(cls, "states", ())):
        try:
            _ = declared.dimension
        except (InputError, ValueError, ArithmeticError) as error:
            return f"declares {declared.symbol}: {error}"
    return None
