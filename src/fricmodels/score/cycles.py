"""The cycles of a periodic torque, for the paper's error over the last two of them."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Mask
from fricmodels.errors import InputError
from fricmodels.recording import Recording


def torque_amplitude(recording: Recording) -> float:
    """Return the amplitude K_I of the motor torque: √2 times its RMS about its mean, over the last two cycles."""
    torque = recording.torque[last_cycles(recording, 2)]
    return float(np.sqrt(2 * np.mean((torque - np.mean(torque)) ** 2)))


def last_cycles(recording: Recording, cycles: int) -> Mask:
    """Mark the samples of the last cycles of the motor torque, from its upward passages through zero.

    The end of the recording counts as a passage where it is within half a sampling interval of one.

    Raises:
        InputError: when the recording has fewer cycles.
    """
    torque = recording.torque
    time = recording.time
    rising = np.flatnonzero((torque[:-1] < 0) & (torque[1:] >= 0))
    if len(rising) == 0:
        raise InputError(f"recording '{recording.name}' has no cycles of torque; use 'score: held-out'")
    share = torque[rising] / (torque[rising] - torque[rising + 1])
    passages = time[rising] + share * (time[rising + 1] - time[rising])
    period = float(np.median(np.diff(passages))) if len(passages) > 1 else float(time[-1] - passages[-1])
    begin = time[-1] + recording.interval - cycles * period
    if begin < time[0] - 0.5 * recording.interval:
        raise InputError(
            f"recording '{recording.name}' has fewer than {cycles} cycles of torque; use 'score: held-out'"
        )
    return np.asarray(time > begin - 0.5 * recording.interval)
