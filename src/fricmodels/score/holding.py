"""The friction torque that may hold a drive at rest, where a rest does not say in which state its memory is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording


def holding_interval(
    drive: Drive,
    recording: Recording,
    values: Mapping[str, float],
    states: Sequence[Array] | None = None,
    limits: tuple[Array, Array] | None = None,
) -> tuple[Array, Array]:
    """Return the least and the greatest friction torque that may hold a drive at rest, shape (N,) each.

    They are the limits at standstill, see :meth:`.Drive.sticking_interval`. Of a state that is unknown at rest
    (:attr:`.State.unknown_at_rest`) the limits with its first value are possible, too: a motor that stands in a gap
    and is pushed has closed it by less than its sensors see.

    Args:
        drive: model. recording: gives the signals. values: parameters by key.
        states: one array for each internal state of the model; by default they are integrated along the motion.
        limits: those at standstill, where they are known.
    """
    declared = drive.model.states
    if states is None and declared:
        states = drive.states(recording, drive.split(values)[1])
    least, greatest = drive.sticking_interval(recording, values, states=states) if limits is None else limits
    if not any(state.unknown_at_rest for state in declared):
        return least, greatest
    pairs = zip(declared, states or (), strict=True)
    other = [np.full(len(recording), state.initial) if state.unknown_at_rest else along for state, along in pairs]
    lower, upper = drive.sticking_interval(recording, values, states=other)
    return np.minimum(least, lower), np.maximum(greatest, upper)
