"""What is registered, by kind and name, and what is left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from fricmodels.errors import InputError, suggestion

if TYPE_CHECKING:
    from fricmodels.term import Effect, Law

GROUP = "fricmodels"
"""The group of entry points."""

T = TypeVar("T")


class LeftOut(InputError):
    """An unknown name where a plugin is left out, which may be the one that has it; the message says why it is."""


@dataclass(frozen=True)
class Failure:
    """A plugin, or a class of it, that could not be used, and why.

    Attributes:
        plugin, distribution: its name, and what was installed that offers it.
        reason: why it is left out.
        concerns: kind and name of the class that cannot be used; ``None`` where that is not known.
        lost: kind and name of what the plugin offered when it was last whole and does not any more.
    """

    plugin: str
    distribution: str
    reason: str
    concerns: tuple[str, str] | None = None
    lost: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        return f"plugin '{self.plugin}' of {self.distribution} is left out: {self.reason}"


@dataclass(frozen=True)
class Registered(Generic[T]):
    """A registered class and the distribution that it came from."""

    cls: type[T]
    distribution: str


class Registry(Generic[T]):
    """The classes of one kind, by name.

    Those whose use hangs or kills the interpreter are not listed; asked for by name, they are there for the workers of
    a tournament, which may die.
    """

    def __init__(
        self,
        kind: str,
        entries: dict[str, Registered[T]],
        failures: tuple[Failure, ...] = (),
        dangers: Mapping[tuple[str, str], str] | None = None,
    ) -> None:
        self.kind = kind
        self._entries = entries
        self._failures = failures
        self._dangers = {name: why for (of, name), why in (dangers or {}).items() if of == kind}

    def __iter__(self) -> Iterator[str]:
        return (name for name in self._entries if name not in self._dangers)

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def __len__(self) -> int:
        return len(self._entries) - len(self._dangers)

    @property
    def names(self) -> tuple[str, ...]:
        """All names, those of classes that are not safe to use among them."""
        return tuple(self._entries)

    def danger(self, name: str) -> str | None:
        """Return what happens to the process that uses a class, or ``None`` where nothing is known to."""
        return self._dangers.get(name.partition("(")[0])

    @property
    def lost(self) -> tuple[str, ...]:
        """Names that plugins had when they were last whole, and those that are not safe to use."""
        names = [name for failure in self._failures for kind, name in failure.lost if kind == self.kind]
        return tuple(name for name in dict.fromkeys([*names, *self._dangers]) if name not in {*self})

    def entry(self, name: str) -> Registered[T]:
        """Return the class and its origin. What stands in brackets after the name, as in ``other(x)``, is not of it.

        Raises:
            LeftOut: where a plugin is left out that may be the one which has the name.
            InputError: naming the nearest known name.
        """
        name = name.partition("(")[0]
        try:
            return self._entries[name]
        except KeyError:
            unknown = f"unknown {self.kind} '{name}'{suggestion(name, self._entries)}"
        asked = (self.kind, name)
        own = [failure for failure in self._failures if asked == failure.concerns or asked in failure.lost]
        if own:
            raise LeftOut(f"{self.kind} '{name}' cannot be used: {own[0]}")
        whole = [failure for failure in self._failures if failure.concerns is None]
        if whole:
            raise LeftOut(f"{unknown} ({'; '.join(map(str, whole))})")
        raise InputError(unknown)

    def __getitem__(self, name: str) -> type[T]:
        return self.entry(name).cls


@dataclass(frozen=True)
class Plugins:
    """All that is registered, what failed to register, and what must not be used in a process that is to live.

    Estimators derive from :class:`fricmodels.estimator.Estimator`, readers from
    :class:`fricmodels.readers.base.Reader`, controllers from :class:`fricmodels.loop.Loop`; all stand above this room.
    """

    laws: Registry[Law]
    effects: Registry[Effect]
    estimators: Registry[Any]
    readers: Registry[Any]
    controllers: Registry[Any]
    failures: tuple[Failure, ...]
    unsafe: tuple[Failure, ...] = ()

    @property
    def registries(self) -> dict[str, Registry[Any]]:
        """The registry of each kind: ``law``, ``effect``, ``estimator``, ``reader``, ``controller``."""
        return {
            "law": self.laws,
            "effect": self.effects,
            "estimator": self.estimators,
            "reader": self.readers,
            "controller": self.controllers,
        }
