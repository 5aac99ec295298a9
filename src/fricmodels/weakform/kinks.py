r"""What smoothing takes away from a velocity where the drive turns, given back: torque and friction tell it.

Where a drive turns its friction jumps from one limit of sticking to the other. Unless the motor torque jumps with it,
the slope of the velocity does,

.. math:: J\dot\omega = \tau_m - \tau_L - \tau_F,

and a filter F rounds that kink off: the velocity passes zero late, by up to a third of the filter's width where the
torque hardly overcomes the friction. An encoder of 4096 counts asks for a filter of 23 samples, and a reversal that is
two samples late is more than all noise of the rows about it. Of the motion u that the equation says, with friction at
its limit on each side, the filter takes away d = u − F u.

Whether it took that away of the motion that was measured, y, says the measurement: what is left of it, e = y − F y, has
as much of d in it as

.. math:: \beta = \sum_r d_r^T e_r \Big/ \sum_r d_r^T d_r,

over the reversals r; their scatter gives its standard error. Where β is clear of 0, β d is given back, with β ≤ 1.
Under a controller so stiff that the motor torque makes up for the jump, β is 0, and nothing is.

Friction changes sides at the instant of the reversal, which is that of the velocity that has d back. It is found in
few rounds: what a slightly wrong instant changes there is of second order.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.recording import Recording
from fricmodels.signals import stretches
from fricmodels.signals.lanczos import DEGREE, even_weights
from fricmodels.weakform.rates import relative_intervals

_ROUNDS = 3
"""In which the instants of the reversals are found."""
_LEAST_REACH = 1
"""Samples to either side that any difference of positions takes: what a contact does within them nobody knows."""
_FEWEST = 5
"""Reversals whose scatter tells a standard error."""
_CERTAIN = 3.0
"""Standard errors from which what smoothing took away is clear."""


def with_kinks(
    recording: Recording,
    smooth: Array,
    half_width: int,
    slow: Mask,
    limits: tuple[Array, Array],
    inertia: float,
    share: float | None = None,
) -> Array:
    """Return the smoothed velocity with what smoothing took away of it about reversals, shape (N,).

    Args:
        recording: whose velocity was smoothed; with the torques.
        smooth: that velocity, shape (N,); where it is 0 it stays so.
        half_width: of the filter; what derived the velocity from positions is known of the recording.
        slow: samples at which the drive creeps or rests, and no reversal is told, shape (N,).
        limits: least and greatest friction torque that holds the drive at rest, shape (N,) each.
        inertia: of the drive; without one nothing is known.
        share: β; as this recording shows it if not given.
    """
    found = _taken_away(recording, smooth, half_width, slow, limits, inertia) if share != 0.0 else None
    if found is None:
        return smooth
    seen = _share_seen(recording, smooth, *found) if share is None else share
    return smooth + seen * found[0] if seen else smooth


def share_of_kinks(
    recording: Recording, smooth: Array, half_width: int, slow: Mask, limits: tuple[Array, Array], inertia: float
) -> float:
    """Return β, which part of the kinks a recording shows; arguments as for :func:`with_kinks`."""
    found = _taken_away(recording, smooth, half_width, slow, limits, inertia)
    return 0.0 if found is None else _share_seen(recording, smooth, *found)


def _taken_away(
    recording: Recording, smooth: Array, half_width: int, slow: Mask, limits: tuple[Array, Array], inertia: float
) -> tuple[Array, Index, int] | None:
    """Return d, shape (N,), the cells in which the drive turns, and the samples to either side that the filter takes.

    ``None`` where the drive turns nowhere, or the filter takes nothing away.
    """
    weights = even_weights(half_width)[0] if half_width > DEGREE // 2 else np.ones(1)  # so few points are met exactly
    if recording.derived_over:
        weights = np.convolve(weights, even_weights(recording.derived_over)[1])
    reach = len(weights) // 2
    if reach <= _LEAST_REACH or inertia <= 0.0:
        return None
    passed, clear = _cells_and_samples(recording, slow, reach)
    around, found, taken = np.arange(-reach, reach + 1), smooth, np.zeros_like(smooth)
    cell = np.zeros(0, dtype=np.int64)
    for _ in range(_ROUNDS):
        cell = np.flatnonzero((found[:-1] * found[1:] < 0.0) & passed)
        near = np.unique(cell[:, None] + np.arange(-reach, reach + 2))
        near = near[(near >= 0) & (near < len(smooth))]
        near = near[clear[near]]
        if not len(near):
            return None
        course = _course(recording, found, cell, limits, inertia)
        path = np.concatenate([[0.0], np.cumsum(0.5 * (course[1:] + course[:-1]))])
        signal = path if recording.derived_over else course
        taken = np.zeros_like(smooth)
        taken[near] = course[near] - signal[near[:, None] + around] @ weights
        taken[smooth == 0.0] = 0.0
        found = smooth + taken
    return taken, cell, reach


def _share_seen(recording: Recording, smooth: Array, taken: Array, cell: Index, reach: int) -> float:
    """Return which part of what smoothing takes away of the equation's motion it took of the measured one, β above.

    Args:
        recording, smooth: the motion, and its smoothed velocity.
        taken: d, shape (N,).
        cell: in which the drive turns.
        reach: samples to either side that the filter takes.
    """
    left = recording.velocity - smooth
    if recording.derived_over:
        length = np.diff(recording.time)
        length = np.where(length > 0.0, length, recording.interval)  # between two runs nothing is taken
        mean = np.diff(recording["position"]) / length - 0.5 * (smooth[1:] + smooth[:-1])
        left, taken = np.append(mean, 0.0), np.append(0.5 * (taken[1:] + taken[:-1]), 0.0)
    # A sample between two reversals belongs to the earlier one: their windows end where the next begins.
    begins = np.maximum(cell - reach, 0)
    edges = np.append(begins, min(int(cell[-1]) + reach + 2, len(smooth)))
    scores = np.add.reduceat(np.append(taken * left, 0.0), edges)[:-1]
    sizes = np.add.reduceat(np.append(taken * taken, 0.0), edges)[:-1]
    whole = float(np.sum(sizes))
    if len(cell) < _FEWEST or whole <= 0.0:
        return 0.0
    share = float(np.sum(scores)) / whole
    error = float(np.sqrt(np.sum((scores - share * sizes) ** 2))) / whole
    return min(share, 1.0) if share > _CERTAIN * error else 0.0


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
    slope *= relative_intervals(recording)[:-1]
    return np.concatenate([[0.0], np.cumsum(slope)]) * (recording.interval / inertia)
