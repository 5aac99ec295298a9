"""What a term sees of a recording when its states can be computed from it directly."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array


class Past:
    """A recorded motion as a term sees it that looks back: ``past.now("velocity")``, ``past.ago("velocity", 0.01)``.

    Args:
        signals: value or array of shape (N,) of each signal.
        time: sample times [s].
        edges: index of the first sample of every run, and N.
    """

    def __init__(self, signals: Mapping[str, ArrayLike], time: Array, edges: list[int]) -> None:
        self._signals, self._time, self._edges = signals, time, edges

    def now(self, name: str) -> Array:
        """Return a signal, shape (N,)."""
        return np.broadcast_to(np.asarray(self._signals[name], dtype=float), self._time.shape)

    def ago(self, name: str, duration: float) -> Array:
        """Return a signal as it was a time before, shape (N,); before a run began, as it was at its beginning."""
        values, time = self.now(name), self._time
        there = np.empty(len(time))
        for begin, end in itertools.pairwise(self._edges):
            own = slice(begin, end)
            there[own] = np.interp(time[own] - duration, time[own], values[own])
        return there

    def followed(self, values: Array, time_constant: float) -> Array:
        """Return what follows values, shape (N,), with a lag of the first order; at the beginning of a run it is there.

        Between samples the values change linearly.
        """
        from fricmodels.kernels.recursion import first_order_lag

        if time_constant <= 0.0:
            return values
        found = np.empty(len(values))
        for begin, end in itertools.pairwise(self._edges):
            own = slice(begin, end)
            first_order_lag(values[own], self._time[own], time_constant, found[own])
        return found
