r"""How certain an instant is, such as that of a jump: by what is left of the rows with every other one.

The squared error has no slope in an instant: it is a stair with a step at each sample. So its interval holds the
instants that leave hardly more,

.. math:: \frac{\nu}{f} \Bigl(\frac{S(t)}{S(\hat t)} - 1\Bigr) \le -2 \ln\bigl(1 - \sqrt{0.95}\bigr) = 7.35

with ν independent equations less the parameters, and f by how much the variances of the linear parameters exceed those
of independent errors. It is at least a sample either way: what happens between two samples is not recorded. Nor does a
drive that rests show when its friction jumps: an interval that ends in a rest holds all of it.

Source: B. E. Hansen, "Sample splitting and threshold estimation", Econometrica 68 (2000), theorem 2; of a jump in time
Y.-C. Yao, Ann. Statist. 15 (1987).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fricmodels.recording import Recording
from fricmodels.signals import smoothed_velocity
from fricmodels.weakform.inference import NORMAL_95
from fricmodels.weakform.ranges import between_strokes

_LIKELY = -2.0 * math.log(1.0 - math.sqrt(0.95))
"""The statistic is less than this with a probability of 0.95, where the instant is the true one."""
_MOVES = 3.0
"""Standard errors of a velocity above which the drive moves for certain."""


def instant_error(recording: Recording, cost: Callable[[float], float], instant: float, certain: float) -> float:
    """Return the standard error [s] of an instant; infinite where no end of its interval can be told.

    ± 1.96 of it reach the further end of the 95 % interval. One that reaches the first or the last instant between
    which a jump could be told has no such end.

    Args:
        recording: its samples.
        cost: squared error with another instant.
        instant: the estimate.
        certain: ν / f.
    """
    time, places = np.unique(recording.time, return_index=True)
    least = cost(instant)

    def likely(gap: int) -> bool:
        return certain * (cost(float(0.5 * (time[gap] + time[gap + 1]))) - least) <= _LIKELY * least

    first, last = np.searchsorted(time, between_strokes(recording)).tolist()
    if first >= last:
        return math.inf
    here = int(np.clip(np.searchsorted(time, instant) - 1, 0, len(time) - 2))
    before = _furthest(likely, here, first, -1)
    after = _furthest(likely, here, min(last, len(time) - 1) - 1, 1)
    if before is None or after is None:
        return math.inf
    velocity, error = smoothed_velocity(recording)
    moves = np.flatnonzero(np.abs(velocity[places]) > _MOVES * error)
    earliest = time[max(moves[moves <= before], default=before)]
    latest = time[min(moves[moves > after], default=after + 1)]
    return max(instant - float(earliest), float(latest) - instant, recording.interval) / NORMAL_95


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
