r"""What smoothing takes away from a velocity where the drive turns, given back: torque and friction tell it.

Where a drive turns its friction jumps from one limit of sticking to the other. Unless the motor torque jumps with it,
the slope of the velocity does,

.. math:: J\dot\omega = \tau_m - \tau_L - \tau_F,

and a filter F rounds that kink off: the velocity passes zero late, by up to a third of the filter's width where the
torque hardly overcomes the friction. An encoder of 4096 counts asks for a filter of 23 samples, and a reversal that is
two samples late is more than all noise of the rows about it. What the filter takes away of the motion u that the
equation says, with friction at its limit on each side, is u − F u; about a reversal the velocity gets it back.

Friction changes sides at the instant of the reversal, which is that of the velocity that has it back. It is found in
few rounds: what a slightly wrong instant changes there is of second order.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.recording import Recording
from fricmodels.signals import stretches
from fricmodels.signals.lanczos import DEGREE, even_weights

_ROUNDS = 3
"""In which the instants of the reversals are found."""


def with_kinks(
    recording: Recording, smooth: Array, half_width: int, slow: Mask, limits: tuple[Array, Array], inertia: float
) -> Array:
    """Return the smoothed velocity with what smoothing took away of it about reversals, shape (N,).

    Args:
        recording: whose velocity was smoothed; with the torques.
        smooth: that velocity, shape (N,); where it is 0 it stays so.
        half_width: of the filter; what derived the velocity from positions is known of the recording.
        slow: samples at which the drive creeps or rests, and no reversal is told, shape (N,).
        limits: least and greatest friction torque that holds the drive at rest, shape (N,) each.
        inertia: of the drive; without one nothing is known.
    """
    weights = even_weights(half_width)[0] if half_width > DEGREE // 2 else np.ones(1)  # so few points are met exactly
    if recording.derived_over:
        weights = np.convolve(weights, even_weights(recording.derived_over)[1])
    reach = len(weights) // 2
    if reach == 0 or inertia <= 0.0:
        return smooth
    passed, clear = _cells_and_samples(recording, slow, reach)
    around, found = np.arange(-reach, reach + 1), smooth
    for _ in range(_ROUNDS):
        cell = np.flatnonzero((found[:-1] * found[1:] < 0.0) & passed)
        near = np.unique(cell[:, None] + np.arange(-reach, reach + 2))
        near = near[(near >= 0) & (near < len(smooth))]
        near = near[clear[near]]
        if not len(near):
            return smooth
        course = _course(recording, found, cell, limits, inertia)
        path = np.concatenate([[0.0], np.cumsum(0.5 * (course[1:] + course[:-1]))])
        signal = path if recording.derived_over else course
        found = smooth.copy()
        found[near] += course[near] - signal[near[:, None] + around] @ weights
        found[smooth == 0.0] = 0.0
    return found


def _cells_and_samples(recording: Recording, slow: Mask, reach: int) -> tuple[Mask, Mask]:
    """Return the cells between samples in which a drive may turn, and the samples that have a whole filter about them.

    Shapes (N − 1,) and (N,).
    """
    passed, clear = ~slow[1:] & ~slow[:-1], np.zeros(len(slow), dtype=bool)
    for part in stretches(recording.time, recording.run):
        clear[part.start + reach : max(part.stop - reach, part.start)] = True
        passed[part.stop - 1 : part.stop] = False
    return passed, clear


def _course(recording: Recording, velocity: Array, cell: Index, limits: tuple[Array, Array], inertia: float) -> Array:
    """Return the velocity that the equation says, but for a constant, shape (N,): its course over few samples counts.

    Args:
        recording: with the torques.
        velocity: tells the side on which friction is at its limit, shape (N,).
        cell: in which the drive turns, by the sample before.
        limits, inertia: see :func:`with_kinks`.
    """
    push, middle, half = recording.driving_torque, 0.5 * (limits[0] + limits[1]), 0.5 * (limits[1] - limits[0])
    side = np.sign(velocity)
    mean = 0.5 * (side[1:] + side[:-1])
    share = velocity[cell] / (velocity[cell] - velocity[cell + 1])  # of the cell, until it turns
    mean[cell] = side[cell] * share + side[cell + 1] * (1.0 - share)
    left = push - middle
    slope = 0.5 * (left[1:] + left[:-1]) - mean * 0.5 * (half[1:] + half[:-1])
    return np.concatenate([[0.0], np.cumsum(slope)]) * (recording.interval / inertia)
