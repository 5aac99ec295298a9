"""What is found once for a recording or another object, and forgotten with it."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

Subject = TypeVar("Subject")
Further = ParamSpec("Further")
Found = TypeVar("Found")


def once(find: Callable[Concatenate[Subject, Further], Found]) -> Callable[Concatenate[Subject, Further], Found]:
    """Let a function find what it does once for each recording or other object; its arrays are not to be written to.

    Of further arguments, which are hashable, once for each of their values.
    """
    known: dict[int, tuple[weakref.ref[Subject], dict[Hashable, Found]]] = {}

    @wraps(find)
    def found(subject: Subject, /, *further: Further.args, **named: Further.kwargs) -> Found:
        place, key = id(subject), (further, *named.items())
        if place not in known or known[place][0]() is not subject:
            known[place] = (weakref.ref(subject, lambda _: known.pop(place, None)), {})
        kept = known[place][1]
        if key not in kept:
            kept[key] = find(subject, *further, **named)
        return kept[key]

    return found
