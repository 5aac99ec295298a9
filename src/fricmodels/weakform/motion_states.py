"""Internal states of models at the samples of a weak-form problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.beginning import Balance
from fricmodels.drive import Drive, rest_width
from fricmodels.memory import Memory
from fricmodels.model import Model
from fricmodels.recording import Recording

_MEMORIES = 2
"""Models, beside the terms with memory of the drive's own, of which it is kept how their states are integrated."""


class MotionStates:
    """What integrates a model's internal states along a smooth motion, or along the whole of which it is a part.

    Args:
        drive: the model under test; its terms without memory are what first states are found beside.
        known: its parameters by key, as far as they are known.
        recording, smooth, resting: the motion, its velocity freed of noise, and where it rests.
        cell: first sample of each cell that the quadrature cuts; its samples are those of the motion, then both ends
            of these cells.
    """

    def __init__(
        self,
        drive: Drive,
        known: Mapping[str, float],
        recording: Recording,
        smooth: Array,
        resting: Mask,
        cell: Index,
    ) -> None:
        self._drive, self._known, self._moving = drive, known, ~resting
        moved = np.where(resting, 0.0, smooth)  # at rest there is only noise, which a state would gather
        along = replace(recording, channels={**recording.channels, "velocity": moved})
        self._whole, self._width = along.whole(), rest_width(along)
        places, origin = np.concatenate([np.arange(len(recording)), cell, cell + 1]), recording.origin
        self._index = np.arange(len(recording)) if origin is None else origin.index
        self._places = self._index[places]
        own = sum(bool(term.states) for term in drive.model.terms)
        self._memory: Callable[[Model], Memory] = lru_cache(_MEMORIES + own)(self._made)

    def __call__(self, model: Model, parameters: Sequence[float] | Array) -> list[Array]:
        """Return each internal state at the quadrature's samples.

        Args:
            model: the whole one, or a term of it, or another one.
            parameters: all of the model's, in order.
        """
        return [state[self._places] for state in self._memory(model)(parameters)]

    def _made(self, model: Model) -> Memory:
        balance = self._balance if model.beginning_unknown else None
        return Drive(model, None, self._drive.motion).memory(self._whole, self._width, balance)

    @cached_property
    def _balance(self) -> Balance | None:
        """Return what the terms without memory leave of the torque, at the samples that are fitted."""
        moving = np.zeros(len(self._whole), dtype=np.bool_)
        moving[self._index] = self._moving
        values = [self._known.get(p.key, p.declared.initial) for p in self._drive.model.parameters]
        return self._drive.balance(self._whole, values, moving)
