"""What is found once for a recording or another object, and forgotten with it."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable
from dataclasses import fields
from functools import partial, wraps
from typing import Any, Concatenate, ParamSpec, TypeVar, cast

Subject = TypeVar("Subject")
Further = ParamSpec("Further")
Found = TypeVar("Found")


class FieldsOnly:
    """A dataclass that is copied and pickled as its fields: what it has found since is found again."""

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: self.__dict__[field.name] for field in fields(cast(Any, self))}


def once(find: Callable[Concatenate[Subject, Further], Found]) -> Callable[Concatenate[Subject, Further], Found]:
    """Let a function find what it does once for each recording or other object; its arrays are not to be written to.

    Of further arguments, which are hashable, once for each of their values.
    """
    known: dict[int, tuple[weakref.ref[Subject], dict[Hashable, Found]]] = {}

    @wraps(find)
    def found(subject: Subject, /, *further: Further.args, **named: Further.kwargs) -> Found:
        place, key = id(subject), (further, *named.items())
        if place not in known or known[place][0]() is not subject:
            # No code of Python's own forgets it: an interrupt within that would be lost. (The reference is a default.)
            known[place] = (weakref.ref(subject, partial(known.pop, place)), {})
        kept = known[place][1]
        if key not in kept:
            kept[key] = find(subject, *further, **named)
        return kept[key]

    return found
