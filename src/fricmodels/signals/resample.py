"""Resampling to an even grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals.segments import stretches


def resample(recording: Recording, interval: float | None = None) -> Recording:
    """Return the recording on an even grid in each stretch between gaps, by linear interpolation.

    Args:
        recording: with samples at any times.
        interval: of the new grid [s]; the median interval if not given. It should not be longer than that:
            nothing is filtered.

    Raises:
        InputError: for an interval that is not positive, or longer than the recording's stretches.
    """
    step = recording.interval if interval is None else interval
    if not (np.isfinite(step) and step > 0):
        raise InputError(f"the sampling interval must be positive, got {step}")
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
