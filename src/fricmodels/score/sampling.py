r"""What sampling hides of a torque error, whatever the model: when a drive turned or stopped, and a shift in time.

Between two samples nothing is known. Three things follow, each of at most one sample:

- The instant of a reversal is known to half a sample on either side. In the intervals about it the mean friction torque
  may lie anywhere between the values that it has for these instants.
- A drive of inertia J that slides against K slower than :math:`K \Delta t / J` may stop within one sample. If the
  torque applied lies within the sticking interval, whether it slides or rests is not known.
- Torque and motion may be shifted against each other by part of a sample: a torque is held, a velocity is a mean.
  A shift γ adds :math:`\gamma\,\dot\tau_m` to the error, with :math:`|\gamma| \le \Delta t`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording

_EITHER = 0.5
"""Part of a sample by which the instant of a reversal may be earlier or later."""


def slowest_certain(drive: Drive, values: Mapping[str, float], recording: Recording) -> Array:
    """Return the speed below which friction could stop the drive within one sample, shape (N,) [rad/s or m/s]."""
    inertia, _ = drive.split(values)
    below, above = drive.sticking_interval(recording, values)
    half = np.maximum(0.5 * (above - below), 0.0)
    return np.asarray(half * recording.interval / inertia if inertia > 0 else np.full(len(half), np.inf))


def about_reversals(velocity: Array, share: Array, below: Array, above: Array) -> tuple[Array, Array]:
    """Return by how much the mean friction torque of each interval may be lower and higher, shape (N − 1,) each.

    Args:
        velocity: of samples in order, shape (N,).
        share: of each interval before the velocity passes zero, shape (N − 1,).
        below, above: friction torque as the drive leaves standstill backward and forward, shape (N,).
    """
    count = len(velocity) - 1
    less, more = np.zeros(count), np.zeros(count)
    at = np.flatnonzero(velocity[:-1] * velocity[1:] < 0)
    share = share[at]
    before = np.where(velocity[at] > 0, above[at], below[at])
    after = np.where(velocity[at] > 0, below[at + 1], above[at + 1])
    for moved in (-_EITHER, _EITHER):
        for step in (-1, 0, 1):
            held = np.clip(share - step, 0.0, 1.0)  # share of the interval before the reversal
            change = (held - np.clip(share + moved - step, 0.0, 1.0)) * (after - before)
            inside = (at + step >= 0) & (at + step < count)
            np.minimum.at(less, (at + step)[inside], change[inside])
            np.maximum.at(more, (at + step)[inside], change[inside])
    return less, more


def without_shift(error: Array, rate: Array, most: float) -> tuple[Array, float]:
    """Return an error without the part that a shift in time makes, shape (N,), and the shift [s].

    Args:
        error: torque error, shape (N,).
        rate: of the torque, filtered as the error was, shape (N,).
        most: largest shift [s].
    """
    power = float(rate @ rate)
    shift = float(np.clip(error @ rate / power, -most, most)) if power > 0 else 0.0
    return error - shift * rate, shift
