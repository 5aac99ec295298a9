"""Arrays that are computed once, while there is room for them."""

from __future__ import annotations

import threading
import weakref
from collections import OrderedDict, deque
from collections.abc import Callable, Hashable
from itertools import count

from fricmodels.arrays import Array, Index

_NUMBERS = count()


class _Owner(weakref.ref[object]):
    """A reference to an owner of arrays, with its number."""

    number: int


class Room:
    """Bytes that several owners share; arrays that nobody asked for longest make room for others.

    Args:
        size: bytes that all arrays together may take.
    """

    def __init__(self, size: int) -> None:
        self.size = self._free = size
        self._arrays: OrderedDict[tuple[int, Hashable], Array] = OrderedDict()
        self._keys: dict[int, set[Hashable]] = {}
        self._turn = threading.RLock()
        self._owners: dict[int, _Owner] = {}
        self._gone: deque[_Owner] = deque()

    def owned_by(self, owner: object) -> int:
        """Return the number of a new owner, whose arrays are forgotten some time after it is gone.

        No code of Python's own runs when it goes: an interrupt within that would be lost.
        """
        reference = _Owner(owner, self._gone.append)
        reference.number = next(_NUMBERS)
        self._owners[reference.number] = reference
        return reference.number

    def get(self, owner: int, key: Hashable) -> Array | None:
        """Return an array that is there."""
        with self._turn:
            known = self._arrays.get((owner, key))
            if known is not None:
                self._arrays.move_to_end((owner, key))
            return known

    def put(self, owner: int, key: Hashable, array: Array) -> None:
        """Keep an array where it fits."""
        with self._turn:
            while self._gone:
                self._forget(self._gone.popleft().number)
            if array.nbytes > self.size or (owner, key) in self._arrays:
                return
            self._arrays[owner, key] = array
            self._keys.setdefault(owner, set()).add(key)
            self._free -= array.nbytes
            while self._free < 0:
                self._drop(*next(iter(self._arrays)))

    def _forget(self, owner: int) -> None:
        for key in [*self._keys.pop(owner, ())]:
            self._drop(owner, key)
        self._owners.pop(owner, None)

    def clear(self) -> None:
        """Let go of all arrays; what is asked for again is computed again."""
        with self._turn:
            while self._arrays:
                self._drop(*next(iter(self._arrays)))

    def _drop(self, owner: int, key: Hashable) -> None:
        self._free += self._arrays.pop((owner, key)).nbytes
        self._keys.get(owner, set()).discard(key)


INTEGRALS = Room(3 * 2**26)
"""Bytes of integrals that all weak-form problems remember."""


class Remembered:
    """Arrays by key; where there is no room for another one, those that were not asked for longest are forgotten.

    Args:
        room: bytes that all of them together may take, or the room that they share with those of others.
    """

    def __init__(self, room: int | Room) -> None:
        self._room = room if isinstance(room, Room) else Room(room)
        self._own = self._room.owned_by(self)

    def __call__(self, key: Hashable, compute: Callable[[], Array]) -> Array:
        """Return the array of a key, which must not be written to."""
        known = self._room.get(self._own, key)
        if known is not None:
            return known
        array = compute()
        array.flags.writeable = False
        self._room.put(self._own, key, array)
        return array

    def known(self, key: Hashable) -> Array | None:
        """Return the array of a key, if it is there."""
        return self._room.get(self._own, key)


class Part(Remembered):
    """Some of the last axis of all arrays; what is known of the whole is not computed anew.

    Args:
        whole: the arrays.
        chosen: which of them, by index.
    """

    def __init__(self, whole: Remembered, chosen: Index) -> None:
        super().__init__(whole._room)
        self._whole, self._chosen = whole, chosen

    def __call__(self, key: Hashable, compute: Callable[[], Array]) -> Array:
        """Return the array of a key, which must not be written to."""

        def part() -> Array:
            whole = self._whole.known(key)
            return compute() if whole is None else whole[..., self._chosen]

        return super().__call__(key, part)
