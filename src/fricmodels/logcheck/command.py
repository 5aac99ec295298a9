"""Whether the torque is a command that has one size in each direction of the motion, or in the only one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import rms
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.signals.switched import one_value_in_each

_MOVES = 0.1
"""Share of the RMS velocity from which the direction counts: about standstill its sign is that of its noise."""


def one_size(log: Log, inertia: float | None) -> Iterator[Finding]:
    r"""Judge whether the torque is one value forward and one backward, or one in the only direction, and nothing else.

    The equation of motion is then fulfilled without any motion: :math:`J = K_v = 0`, and a Coulomb friction, with an
    offset where the two sizes differ, is the command itself, to the last digit. So it is in a step response, or where a
    relay drives the motion that it is switched by. With the inertia given, the motion has to be explained.
    """
    recording, velocity = log.recording, log.velocity
    if inertia is not None or not recording.torque.any():
        return
    moves = np.abs(velocity) > _MOVES * rms(velocity)
    forward = velocity[moves] > 0.0
    torque = recording.torque[moves]
    if np.ptp(recording.torque) == 0.0 or not len(torque) or not one_value_in_each(torque, forward):
        return  # what never changes is another finding
    ways = {"forward": forward, "backward": ~forward}
    values = {way: float(np.median(torque[inside])) for way, inside in ways.items() if inside.any()}
    if len(set(values.values())) == 1:
        sizes = (
            f"{log.size('torque', next(iter(values.values())))} wherever the {'joint' if log.rotary else 'axis'} moves"
        )
    else:
        sizes = ", ".join(f"{log.size('torque', value)} {way}" for way, value in values.items())
    yield Finding(
        "one-command",
        Severity.STOP,
        "torque",
        f"the {log.called('torque')} is {sizes} and nothing else: a Coulomb friction of that size explains it without "
        "any motion",
        "give the inertia (--inertia), or record commands of several sizes in each direction",
    )
