"""The way about standstill of which a recording tells nothing."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import rms
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.lanczos import lanczos_value
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.rest import smoothed_velocity

SHORTEST = 2.0
"""The shortest duration that can be told, in sampling intervals: sampling alone delays by part of one."""
_COUNTS = 2.0
"""And the shortest way, in counts of the position that tells the motion."""
_LOW, _SLOWER, _WIDTH = 0.2, 0.25, 2
"""Share of the RMS speed that is low; share of what is passed at low speed that is passed more slowly than by the usual
acceleration; samples to either side of one from which its acceleration is told."""


def unseen_way(recording: Recording) -> float:
    """Return the way about a reversal [rad or m] of which nothing can be told."""
    in_samples = 0.5 * (SHORTEST * recording.interval) ** 2 * turning(recording)
    return max(in_samples, _COUNTS * quantum(recording["position"]) if recording.derived_over else 0.0)


@once
def turning(recording: Recording) -> float:
    """Return the acceleration with which the drive passes standstill, at the slower of its passages.

    Where the speed is low but certain. Each sample counts by the change of speed that it stands for: a rest, or a slow
    stretch at constant speed, passes nothing.
    """
    velocity, error = smoothed_velocity(recording)
    speed = np.abs(velocity)
    low = (speed > 3.0 * error) & (speed <= _LOW * rms(velocity))
    if not low.any():
        return 0.0
    rate = np.sort(np.abs(lanczos_value(recording.time, velocity, _WIDTH, recording.run, order=1))[low])
    passed = np.cumsum(rate)
    return float(rate[np.searchsorted(passed, _SLOWER * passed[-1])])
