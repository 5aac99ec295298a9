"""Where the drive moves, as another channel shows it than the one that is judged."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Mask
from fricmodels.logcheck.view import Log
from fricmodels.signals.noise_level import noise

_HALF = 4
"""Samples on each side over which a position must change."""
_CLEAR = 4.0
"""Steps of the grid, or standard deviations of the noise, by which a motion stands out."""


def moving(log: Log, channel: str) -> Mask | None:
    """Return at which samples the drive moves, shape (N,); ``None`` where no other channel than the given one tells.

    The position tells it: it must change by four steps of its grid, and by four times its noise, over four samples on
    each side. Else the velocity does, where it is as far from zero. At a standstill values may rightly stay the same.
    """
    measured = log.measured
    if channel != "position" and "position" in measured:
        position, index = measured["position"], np.arange(len(log.recording))
        part = log.part
        before, after = np.maximum(index - _HALF, 0), np.minimum(index + _HALF, len(index) - 1)
        within = (part[before] == part) & (part[after] == part)
        return np.asarray(within & (np.abs(position[after] - position[before]) > _least(log, "position")))
    if channel != "velocity" and "velocity" in measured:
        return np.asarray(np.abs(measured["velocity"]) > _least(log, "velocity"))
    return None


def _least(log: Log, channel: str) -> float:
    short = log.short.recording
    return _CLEAR * max(log.resolution[channel], noise(short.time, short[channel], short.run))
