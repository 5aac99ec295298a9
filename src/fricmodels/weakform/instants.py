r"""How certain an instant is, such as that of a jump: by what is left of the rows with every other one.

The squared error has no slope in an instant: it is a stair with a step at each sample. So its interval holds the
instants that leave hardly more,

.. math:: \frac{\nu}{f} \Bigl(\frac{S(t)}{S(\hat t)} - 1\Bigr) \le -2 \ln\bigl(1 - \sqrt{0.95}\bigr) = 7.35

with ν independent equations less the parameters, and f by how much the variances of the linear parameters exceed those
of independent errors. It is at least a sample either way: what happens between two samples is not recorded. Nor does a
drive that rests show when its friction jumps: an interval that ends in a rest holds all of it.

What else is fitted may be another at another likely instant. After a jump a drive may have moved forth long ago and
back only since: then the sum of a jump of the Coulomb torque and of a constant one is known, and each of them hangs on
the instant. So other parameters may be off by as much as they move within the interval, and are known no better than
they are at the likely instant that says least of them.

Source: B. E. Hansen, "Sample splitting and threshold estimation", Econometrica 68 (2000), theorem 2; of a jump in time
Y.-C. Yao, Ann. Statist. 15 (1987).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording
from fricmodels.signals import smoothed_velocity
from fricmodels.weakform.inference import NORMAL_95
from fricmodels.weakform.ranges import between_strokes

_LIKELY = -2.0 * math.log(1.0 - math.sqrt(0.95))
"""The statistic is less than this with a probability of 0.95, where the instant is the true one."""
_MOVES = 3.0
"""Standard errors of a velocity above which the drive moves for certain."""
_WITHIN = 9
"""Instants all over an interval at which the other parameters are fitted anew."""


@dataclass(frozen=True)
class LikelyInstants:
    """Instants that leave hardly more than the best of them.

    Attributes:
        error: standard error [s] of the instant; infinite where no end of its interval can be told. ± 1.96 of it reach
            the further end of the 95 % interval.
        within: likely instants all over the interval [s], shape (n,).
    """

    error: float
    within: Array


def likely_instants(
    recording: Recording, cost: Callable[[float], float], instant: float, certain: float
) -> LikelyInstants:
    """Return the interval of an instant. One that reaches the first or the last that could be told has no such end.

    Args:
        recording: its samples.
        cost: squared error with another instant.
        instant: the estimate.
        certain: ν / f.
    """
    time, places = np.unique(recording.time, return_index=True)
    middles, least = 0.5 * (time[1:] + time[:-1]), cost(instant)

    def likely(gap: int) -> bool:
        return certain * (cost(float(middles[gap])) - least) <= _LIKELY * least

    first, last = np.searchsorted(time, between_strokes(recording)).tolist()
    if first >= last:
        return LikelyInstants(math.inf, np.zeros(0))
    here = int(np.clip(np.searchsorted(time, instant) - 1, 0, len(time) - 2))
    ends = first, min(last, len(time) - 1) - 1
    before, after = (_furthest(likely, here, end, way) for end, way in zip(ends, (-1, 1), strict=True))
    known = [end if found is None else found for found, end in zip((before, after), ends, strict=True)]
    velocity, error = smoothed_velocity(recording)
    moves = np.flatnonzero(np.abs(velocity[places]) > _MOVES * error)
    earliest = int(max(moves[moves <= known[0]], default=known[0]))
    latest = int(min(moves[moves > known[1]], default=known[1] + 1))
    tried = np.linspace(known[0], known[1], _WITHIN).round().astype(np.int64)
    likely_ones = [earliest, *(gap for gap in np.unique(tried).tolist() if likely(gap)), latest - 1]
    within = middles[np.unique(likely_ones)]
    if before is None or after is None:
        return LikelyInstants(math.inf, within)
    furthest = max(instant - float(time[earliest]), float(time[latest]) - instant, recording.interval)
    return LikelyInstants(furthest / NORMAL_95, within)


def _furthest(likely: Callable[[int], bool], here: int, end: int, way: int) -> int | None:
    """Return the furthest gap between samples that is likely, in steps that double, then halve; ``None`` at the end."""
    known, step = here, 1
    while True:
        place = known + way * step
        if (end - place) * way < 0:
            if likely(end) or (end - known) * way <= 0:
                return None
            place = end
        elif likely(place):
            known, step = place, 2 * step
            continue
        while abs(place - known) > 1:
            middle = (place + known) // 2
            known, place = (middle, place) if likely(middle) else (known, middle)
        return known
