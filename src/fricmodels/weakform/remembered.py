"""Arrays that are computed once, while there is room for them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Remembered:
    """Arrays by key; where there is no room for another one, those that were not asked for longest are forgotten.

    Args:
        room: bytes that all of them together may take.
    """

    def __init__(self, room: int) -> None:
        self._room = self._free = room
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
        return array
