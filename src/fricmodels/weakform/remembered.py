"""Arrays that are computed once, while there is room for them."""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Callable, Hashable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TOGETHER = 2**29
"""Bytes that the arrays of all who remember may take together: a ladder keeps the rows of each of its models."""

STEP = 2**20
"""Bytes more after which that is looked at."""


class Remembered:
    """Arrays by key; where there is no room for another one, those that were not asked for longest are forgotten.

    Where all who remember hold more than :data:`TOGETHER`, those forget everything that were not asked for longest.

    Args:
        room: bytes that all of them together may take.
    """

    def __init__(self, room: int) -> None:
        self._room = self._free = room
        self._counted = 0
        self._arrays: OrderedDict[Hashable, Array] = OrderedDict()

    def __call__(self, key: Hashable, compute: Callable[[], Array]) -> Array:
        """Return the array of a key, which must not be written to."""
        known = self._arrays.get(key)
        if known is not None:
            self._arrays.move_to_end(key)
            return known
        array = compute()
        array.flags.writeable = False
        if array.nbytes <= self._room:
            self._arrays[key] = array
            self._free -= array.nbytes
        while self._free < 0:
            self._free += self._arrays.popitem(last=False)[1].nbytes
        if self.held > self._counted + STEP:
            self._counted = self.held
            _make_room(self)
        return array

    @property
    def held(self) -> int:
        """Bytes that its arrays take."""
        return self._room - self._free

    def forget(self) -> None:
        """Forget everything."""
        self._arrays.clear()
        self._free, self._counted = self._room, 0


_asked: OrderedDict[int, weakref.ref[Remembered]] = OrderedDict()
"""Who remembers, the one that was last given much that is new at the end."""


def _make_room(last: Remembered) -> None:
    """Let the others forget, those first that were given nothing new for longest, while all hold too much."""
    key = id(last)
    if key not in _asked:
        _asked[key] = weakref.ref(last, lambda _: _asked.pop(key, None))
    _asked.move_to_end(key)
    holding = [each for each in (ref() for ref in list(_asked.values())) if each is not None]
    held = sum(each.held for each in holding)
    for each in holding[:-1]:
        if held <= TOGETHER:
            return
        held -= each.held
        each.forget()
