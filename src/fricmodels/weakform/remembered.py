"""Arrays that are computed once, while there is room for them."""

from __future__ import annotations

from collections.abc import Callable, Hashable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Remembered:
    """Arrays by key; those that no longer fit are computed anew each time.

    Args:
        room: bytes that all of them together may take.
    """

    def __init__(self, room: int) -> None:
        self._room = room
        self._arrays: dict[Hashable, Array] = {}

    def __call__(self, key: Hashable, compute: Callable[[], Array]) -> Array:
        """Return the array of a key, which must not be written to."""
        known = self._arrays.get(key)
        if known is not None:
            return known
        array = compute()
        array.flags.writeable = False
        if array.nbytes <= self._room:
            self._arrays[key] = array
            self._room -= array.nbytes
        return array
