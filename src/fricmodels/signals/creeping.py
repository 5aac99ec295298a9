"""A drive that creeps under less friction than slides: it is held, and moves all the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from fricmodels.arrays import Array, Mask, rms
from fricmodels.recording import Recording
from fricmodels.signals.in_place import pieces
from fricmodels.signals.rest import passage

_CREEPS, _WELL_WITHIN = 0.01, 0.8
"""Share of the RMS speed up to which a drive may creep, and of the friction that holds it up to which it does not
slide. Judgements: friction of a drive that slides is hardly known to a fifth of it before a model is fitted."""
_LEAST = 4
"""Samples beyond which a drive may creep."""


def creeping_speed(smooth: Array) -> float:
    """Return the speed up to which a drive of a velocity freed of noise, shape (N,), may creep."""
    return _CREEPS * rms(smooth) if len(smooth) else 0.0


def creeping_stretches(recording: Recording, smooth: Array, rest: Mask, up_to: float) -> list[tuple[int, int]]:
    """Return where a drive moves so slowly for longer than a passage lasts: first sample, and the one after the last.

    Args:
        recording: prepared.
        smooth: velocity freed of noise, shape (N,).
        rest: samples at which the drive stands still, as far as its sensors show, shape (N,).
        up_to: see :func:`creeping_speed`.
    """
    slow = (np.abs(smooth) <= up_to) & ~rest
    found = [(begin, end) for begin, end in pieces(recording, slow) if end - begin > _LEAST]
    passes, time = passage(recording, smooth, up_to) if found else 0.0, recording.time
    return [(begin, end) for begin, end in found if time[end - 1] - time[begin] > passes]


def held_while_creeping(
    recording: Recording,
    smooth: Array,
    creeps: Sequence[tuple[int, int]],
    inertia: float,
    limits: Callable[[], tuple[Array, Array]],
) -> Mask:
    r"""Mark stretches in which a drive creeps under less friction than slides, shape (N,).

    A sensor that is fine enough shows a motion where a contact gives way, or where a simulator's friction rises with
    the speed from nothing. Its direction is certain, but :math:`\pm K_c` does not act: on average over the stretch
    :math:`\tau - J \dot\omega` lies well within the friction torques that hold the drive at rest.

    Args:
        recording: prepared.
        smooth: velocity freed of noise, shape (N,).
        creeps: see :func:`creeping_stretches`.
        inertia: of the drive.
        limits: gives least and greatest friction torque that holds the drive at rest, shape (N,) each.
    """
    found, time = np.zeros(len(recording), dtype=bool), recording.time
    if not creeps:
        return found
    least, most = limits()
    for begin, end in creeps:
        change = (smooth[end - 1] - smooth[begin]) / (time[end - 1] - time[begin])
        low, high = (float(np.mean(limit[begin:end])) for limit in (least, most))
        pushed = float(np.mean(recording.torque[begin:end] - recording.load_torque[begin:end])) - inertia * change
        found[begin:end] = abs(pushed - 0.5 * (low + high)) < _WELL_WITHIN * 0.5 * (high - low)
    return found
