"""A drive that creeps under less friction than slides: it is held, and moves all the same."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import Recording
from fricmodels.signals.segments import stretches

_CREEPS, _WELL_WITHIN = 0.01, 0.8
"""Share of the RMS speed up to which a drive may creep, and of the friction that holds it up to which it does not
slide. Judgements: friction of a drive that slides is hardly known to a fifth of it before a model is fitted."""
_LEAST = 4
"""Samples beyond which a drive creeps, and does not only pass."""


def creeping_speed(smooth: Array) -> float:
    """Return the speed up to which a drive of a velocity freed of noise, shape (N,), may creep."""
    return _CREEPS * float(np.sqrt(np.mean(smooth**2))) if len(smooth) else 0.0


def held_while_creeping(
    recording: Recording, smooth: Array, inertia: float, limits: tuple[Array, Array], up_to: float
) -> Mask:
    r"""Mark stretches in which a drive creeps under less friction than slides, shape (N,).

    A sensor that is fine enough shows a motion where a contact gives way, or where a simulator's friction rises with
    the speed from nothing. Its direction is certain, but :math:`\pm K_c` does not act: on average over the stretch
    :math:`\tau - J \dot\omega` lies well within the friction torques that hold the drive at rest.

    Args:
        recording: prepared.
        smooth: velocity freed of noise.
        inertia: of the drive.
        limits: least and greatest friction torque that holds the drive at rest, shape (N,) each.
        up_to: see :func:`creeping_speed`.
    """
    slow = np.abs(smooth) <= up_to
    middle, half = 0.5 * (limits[0] + limits[1]), 0.5 * (limits[1] - limits[0])
    beside, found = recording.driving_torque - middle, np.zeros(len(recording), dtype=bool)
    for part in stretches(recording.time, recording.run):
        edges = np.flatnonzero(np.diff(np.r_[0, slow[part].astype(np.int8), 0])) + part.start
        for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            if end - begin <= _LEAST:
                continue
            change = (smooth[end - 1] - smooth[begin]) / (recording.time[end - 1] - recording.time[begin])
            needed = abs(float(np.mean(beside[begin:end])) - inertia * change)
            found[begin:end] = needed < _WELL_WITHIN * float(np.mean(half[begin:end]))
    return found
