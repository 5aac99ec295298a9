"""Samples that an even clock should have given and that a log does not have, between others."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.segments import joined, usual_steps
from fricmodels.signals.stamps import WHOLE, unevenness

_WANDER = 0.1
"""Unevenness of stamps up to which a long interval is one in which samples are lost."""


@once
def lost_samples(recording: Recording) -> Array:
    """Return how many samples are lost after each but the last one, shape (N − 1,); none across a gap.

    An interval that is a whole multiple of the usual one lacks some. Where the stamps wander by more than a tenth of it
    that is not told; a stamp that came late makes a long interval and then a short one, and nothing is lost.
    """
    step = np.diff(recording.time)
    none = np.zeros(len(step))
    if not recording.interval > 0.0 or unevenness(recording) > _WANDER:
        return none
    ratio = step / usual_steps(recording.time, recording.run)
    number = np.rint(ratio)
    whole = (number > 1.0) & (np.abs(ratio - number) < WHOLE)
    if not whole.any():
        return none
    whole &= joined(recording.time, recording.run)
    whole &= (np.r_[ratio[1:], 1.0] > 1.0 - 2.0 * WHOLE) & (np.r_[1.0, ratio[:-1]] > 1.0 - 2.0 * WHOLE)
    return np.where(whole, number - 1.0, 0.0)


def as_held(recording: Recording) -> Recording:
    r"""Return a recording whose torque is the mean after each sample, where a controller renews and holds it at each.

    That is the sample itself. Where m samples are lost after it, what they were lies on a straight line to the next
    one,

    .. math:: \bar\tau_k = \tau_k + \frac{m}{2(m + 1)}\,(\tau_{k+1} - \tau_k).

    Held over all of a long interval a torque would be late by most of it.
    """
    return _with_lost_samples(recording) or recording


@once
def _with_lost_samples(recording: Recording) -> Recording | None:
    """Return what is held where some samples are lost; ``None`` where none are."""
    lost = lost_samples(recording)
    if not lost.any():
        return None
    torque = recording.torque.copy()
    torque[:-1] += 0.5 * lost / (lost + 1.0) * np.diff(torque)
    return recording.with_channels(derived=False, torque=torque)
