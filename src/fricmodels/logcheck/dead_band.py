r"""Whether a channel has a dead band: it is one value as long as what it measures is near that.

The band is the gap around the most frequent value in which no sample lies. Beside it, in a band of the same width
on each side, lie n samples. Were the gap none, each of them would have fallen into it as often as not, and that none
did has the chance :math:`2^{-n}`, on each side. A grid has gaps too: the one looked at must be many times as wide as
those between the values beside it.

What is switched also leaves a gap: it jumps over it. What goes through a dead band comes to its edge first. So
the samples right before and after the one value must lie beside the gap more often than other samples do, by the
binomial test.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.moving import moving
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.clusters import LEVEL
from fricmodels.signals.switched import is_switched

_LEAST_SHARE = 0.005
"""Share of the samples in motion from which the one value is worth a word."""
_WIDER = 4.0
"""Times the widest gap between values beside it, from which a gap is none of the grid."""


@dataclass(frozen=True)
class _Band:
    """A gap around one value: its ends, and the share of the samples in motion that have the value."""

    value: float
    low: float
    high: float
    share: float

    @property
    def width(self) -> float:
        """The narrower of both sides."""
        return min(self.high - self.value, self.value - self.low)


def dead(log: Log) -> Iterator[Finding]:
    """Say which channel is one value throughout a band, while the drive moves; how is told at the top of this file."""
    for channel in ("torque", "velocity", "acceleration"):
        values, moves = log.measured.get(channel), moving(log, channel)
        if values is None or moves is None or is_switched(values):
            continue
        band = _found(values, moves, log.joined)
        if band is None:
            continue
        unit = log.unit(channel)
        yield Finding(
            "dead-band",
            Severity.WARN,
            channel,
            f"the {log.called(channel)} has a dead band: while the drive moves {figures(100 * band.share)} % of its "
            f"samples are exactly {figures(band.value, 4)} {unit}, and no other is between {figures(band.low, 3)} and "
            f"{figures(band.high, 3)} {unit}; what happened there is lost",
            "switch off the threshold of the sensor or the logger, or use a finer sensor; if the drive itself commands "
            "nothing there the values are true",
        )


def _found(values: Array, moves: Mask, joined: Mask) -> _Band | None:
    """Return the dead band of a channel, if it has one."""
    kept, count = np.unique(values[moves], return_counts=True)
    if not len(kept):
        return None
    value, share = float(kept[np.argmax(count)]), float(count.max()) / int(np.count_nonzero(moves))
    below, above = values[values < value], values[values > value]
    if share < _LEAST_SHARE or not len(below) or not len(above):
        return None
    band = _Band(value, float(below.max()), float(above.min()), share)
    wide = all(_is_wide(np.abs(side - value), band.width) for side in (below, above))
    return band if wide and _is_come_to(band, values, moves, joined) else None


def _is_wide(distance: Array, width: float) -> bool:
    """Whether a gap is wider than chance and the grid allow, by the distances of all samples on its other side."""
    near = distance[distance <= distance.min() + width]
    steps = np.diff(np.unique(near))
    return len(steps) > 1 and 0.5 ** len(near) < LEVEL and width > _WIDER * float(steps.max())


def _is_come_to(band: _Band, values: Array, moves: Mask, joined: Mask) -> bool:
    """Whether samples next to the one value lie beside the gap more often than others do."""
    from scipy.special import bdtrc

    same = values == band.value
    border = np.flatnonzero(joined & moves[1:] & moves[:-1] & (same[1:] != same[:-1]))
    others = moves & ~same
    if not len(border) or not others.any():
        return False
    beside = (values >= band.low - band.width) & (values <= band.high + band.width) & ~same
    found = int(np.count_nonzero(beside[border] | beside[border + 1]))
    return bool(bdtrc(found - 1, len(border), float(np.mean(beside[others]))) < LEVEL)
