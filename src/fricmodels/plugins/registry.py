"""What is registered, by kind and name, and what is left out."""

from __future__ import annotations

from collections.abc import Iterator
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
    """The classes of one kind, by name."""

    def __init__(self, kind: str, entries: dict[str, Registered[T]], failures: tuple[Failure, ...] = ()) -> None:
        self.kind = kind
        self._entries = entries
        self._failures = failures

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def __len__(self) -> int:
        return len(self._entries)

    @property
    def lost(self) -> tuple[str, ...]:
        """Names that plugins had when they were last whole; asking for one says why it is gone."""
        names = [name for failure in self._failures for kind, name in failure.lost if kind == self.kind]
        return tuple(name for name in dict.fromkeys(names) if name not in self._entries)

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
    """All that is registered, and what failed to register.

    Estimators derive from :class:`fricmodels.estimator.Estimator`, readers from
    :class:`fricmodels.readers.base.Reader`; both stand above this room.
    """

    laws: Registry[Law]
    effects: Registry[Effect]
    estimators: Registry[Any]
    readers: Registry[Any]
    failures: tuple[Failure, ...]

    @property
    def registries(self) -> dict[str, Registry[Any]]:
        """The registry of each kind: ``law``, ``effect``, ``estimator``, ``reader``."""
        return {"law": self.laws, "effect": self.effects, "estimator": self.estimators, "reader": self.readers}
