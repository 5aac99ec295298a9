"""The cells between the samples of a recording, and which of them lie in a stretch without a gap."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.segments import joined


@once
def cells_of(recording: Recording) -> tuple[Array, Mask]:
    """Return the duration of each cell, 0 between stretches, and which cells lie within one."""
    within = joined(recording.time, recording.run)
    return np.where(within, np.diff(recording.time), 0.0), within
