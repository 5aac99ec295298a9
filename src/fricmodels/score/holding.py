"""The friction torque that may hold a drive at rest, where a rest does not say in which state its memory is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.signals.unseen_way import unseen_way


def holding_interval(
    drive: Drive,
    recording: Recording,
    values: Mapping[str, float],
    states: Sequence[Array] | None = None,
    limits: tuple[Array, Array] | None = None,
    way: float = 0.0,
) -> tuple[Array, Array]:
    """Return the least and the greatest friction torque that may hold a drive at rest, shape (N,) each.

    They are the limits at standstill, see :meth:`.Drive.sticking_interval`. At rest a drive may have gone a way that no
    sensor sees, to either side: a contact that bends within it has any torque that it can have there. Of a state that
    is unknown at rest (:attr:`.State.unknown_at_rest`) the limits with its first value are possible, too: a motor that
    stands in a gap and is pushed has closed it by less than its sensors see.

    Args:
        drive: model. recording: gives the signals. values: parameters by key.
        states: one array for each internal state of the model; by default they are integrated along the motion.
        limits: those at standstill, where they are known.
        way: that is not seen [rad or m], see :func:`unseen_at_rest`.
    """
    if states is None and drive.model.states:
        states = drive.states(recording, drive.split(values)[1])
    least, greatest = drive.sticking_interval(recording, values, states=states) if limits is None else limits
    for other in _possible(drive, recording, values, states or (), way):
        lower, upper = drive.sticking_interval(recording, values, states=other)
        least, greatest = np.minimum(least, lower), np.maximum(greatest, upper)
    return least, greatest


def _possible(
    drive: Drive, recording: Recording, values: Mapping[str, float], states: Sequence[Array], way: float
) -> Iterator[Sequence[Array]]:
    """Yield the states that a drive at rest may have beside those that the recorded motion leads to."""
    declared = drive.model.states
    if any(state.unknown_at_rest for state in declared):
        pairs = zip(declared, states, strict=True)
        yield [np.full(len(recording), state.initial) if state.unknown_at_rest else along for state, along in pairs]
    for side in (1.0, -1.0) if declared and way > 0.0 else ():
        yield drive.states_moved(recording, drive.split(values)[1], states, side * way)


def unseen_at_rest(drive: Drive, recording: Recording) -> float:
    """Return the way at rest that a recording does not show [rad or m]; 0 for a model without memory, which needs none.

    From where it stopped, and to where it starts, each about a reversal.
    """
    return 2.0 * unseen_way(recording) if drive.model.states else 0.0
