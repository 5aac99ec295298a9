"""First samples whose velocity is not the drive's: a difference has nothing before it to begin from."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Index
from fricmodels.recording import Recording
from fricmodels.signals.segments import stretches

_FAR = 10.0
"""A first sample is false if it bends the course of the velocity so many times as much as any other sample does."""
_LEAST = 50
"""Samples of a stretch from which the largest bend is known."""


def false_beginnings(recording: Recording) -> Index:
    """Return the places of samples that begin a stretch with a false velocity, as a difference does that begins with 0.

    The second difference there exceeds ten times the largest one in all the rest of the stretch, whatever its noise.
    """
    found = []
    if "velocity" in recording and "velocity" not in recording.derived:
        for part in stretches(recording.time, recording.run):
            if part.stop - part.start >= _LEAST:
                bend = np.abs(np.diff(recording.velocity[part], 2))
                if bend[0] > _FAR * float(bend[1:].max()) > 0.0:
                    found.append(part.start)
    return np.array(found, dtype=np.int64)


def with_true_beginnings(recording: Recording) -> Recording:
    """Return the recording with the line through the next two samples in place of every false first velocity."""
    at = false_beginnings(recording)
    if not len(at):
        return recording
    velocity = recording.velocity.copy()
    velocity[at] = 2.0 * velocity[at + 1] - velocity[at + 2]
    return recording.with_channels(derived=False, velocity=velocity)
