"""Resampling to an even grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals.segments import stretches


def resample(recording: Recording) -> Recording:
    """Return the recording on a grid of its median interval in each stretch between gaps, by linear interpolation.

    Args:
        recording: with samples at any times.

    Raises:
        InputError: where no stretch is as long as that.
    """
    step = recording.interval
    channels: dict[str, list[np.ndarray]] = {name: [] for name in recording.channels}
    runs = []
    for part in stretches(recording.time, recording.run):
        time = recording.time[part]
        count = int(np.floor((time[-1] - time[0]) / step * (1 + 1e-12))) + 1
        if count < 2:
            continue
        grid = time[0] + step * np.arange(count)
        for name, values in recording.channels.items():
            channels[name].append(grid if name == "time" else np.interp(grid, time, values[part]))
        runs.append(np.full(count, recording.run[part.start]))
    if not runs:
        raise InputError(f"no stretch of recording '{recording.name}' is as long as {step:g} s")
    even = {name: np.concatenate(parts) for name, parts in channels.items()}
    return replace(recording, channels=even, run=np.concatenate(runs))
