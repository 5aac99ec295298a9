"""A drive that creeps under less friction than slides: it is held, and moves all the same."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import Recording
from fricmodels.signals.rest import passage
from fricmodels.signals.segments import stretches

_CREEPS, _WELL_WITHIN = 0.01, 0.8
"""Share of the RMS speed up to which a drive may creep, and of the friction that holds it up to which it does not
slide. Judgements: friction of a drive that slides is hardly known to a fifth of it before a model is fitted."""
_LEAST = 4
"""Samples beyond which a drive may creep."""


def creeping_speed(smooth: Array) -> float:
    """Return the speed up to which a drive of a velocity freed of noise, shape (N,), may creep."""
    return _CREEPS * float(np.sqrt(np.mean(smooth**2))) if len(smooth) else 0.0


def held_while_creeping(
    recording: Recording,
    smooth: Array,
    rest: Mask,
    inertia: float,
    limits: Callable[[], tuple[Array, Array]],
    up_to: float,
) -> Mask:
    r"""Mark stretches in which a drive creeps under less friction than slides, shape (N,).

    A sensor that is fine enough shows a motion where a contact gives way, or where a simulator's friction rises with
    the speed from nothing. Its direction is certain, but :math:`\pm K_c` does not act: on average over the stretch,
    which lasts longer than a passage through such speeds, :math:`\tau - J \dot\omega` lies well within the friction
    torques that hold the drive at rest.

    Args:
        recording: prepared.
        smooth: velocity freed of noise.
        rest: samples at which the drive stands still, as far as its sensors show.
        inertia: of the drive.
        limits: gives least and greatest friction torque that holds the drive at rest, shape (N,) each.
        up_to: see :func:`creeping_speed`.
    """
    found, slow = np.zeros(len(recording), dtype=bool), (np.abs(smooth) <= up_to) & ~rest
    pieces = [
        (begin, end)
        for part in stretches(recording.time, recording.run)
        for begin, end in _stretches_of(slow[part], part.start)
        if end - begin > _LEAST
    ]
    del slow
    if not pieces:
        return found
    passes, time = passage(recording, smooth, up_to), recording.time
    pieces = [(begin, end) for begin, end in pieces if time[end - 1] - time[begin] > passes]
    if not pieces:
        return found
    least, most = limits()
    for begin, end in pieces:
        change = (smooth[end - 1] - smooth[begin]) / (time[end - 1] - time[begin])
        low, high = (float(np.mean(limit[begin:end])) for limit in (least, most))
        pushed = float(np.mean(recording.torque[begin:end] - recording.load_torque[begin:end])) - inertia * change
        found[begin:end] = abs(pushed - 0.5 * (low + high)) < _WELL_WITHIN * 0.5 * (high - low)
    return found


def _stretches_of(marked: Mask, start: int) -> list[tuple[int, int]]:
    """Return where stretches of marked samples begin and have ended, counted from a sample on."""
    edges = np.flatnonzero(np.diff(np.r_[0, marked.astype(np.int8), 0])) + start
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
