"""Where held numbers of a model are taken further than the recording that they were fitted to."""

from __future__ import annotations

import numpy as np

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.recording import CHANNELS
from fricmodels.results.comparison import BeyondRange

_MARGIN = 0.05
"""Share of the range by which a channel may go beyond it: another recording of the same motion does, and its noise."""
_LEAST = 0.01
"""Share of the samples from which it is told; one sample in a hundred hardly shows in an error."""


def beyond_range(comparison: Comparison) -> tuple[BeyondRange, ...]:
    """Return the channels that a held model needs and that leave the range of its numbers, with how much of them does.

    What a law says there is no measurement: a curve that fits to 0.5 rad/s may turn negative at 1.5.
    """
    drive, known = comparison.drive, comparison.drive.model.known
    if not known.fixed:
        return ()
    found = []
    for channel in sorted(drive.model.needs & known.ranges.keys() & CHANNELS.keys()):
        least, greatest = known.ranges[channel]
        values = np.concatenate([part[channel] for part in (comparison.train, comparison.test) if channel in part])
        margin = _MARGIN * (greatest - least)
        share = float(np.mean((values < least - margin) | (values > greatest + margin))) if len(values) else 0.0
        if share >= _LEAST:
            unit = CHANNELS[channel].unit(drive.motion)
            found.append(
                BeyondRange(channel=channel, share_of_samples=share, least=least, greatest=greatest, unit=unit)
            )
    return tuple(found)
