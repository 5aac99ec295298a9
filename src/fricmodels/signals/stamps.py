r"""Time stamps that wander though the samples were even: how much of it is true, and even stamps in their place.

A message is stamped when it is written, the sensor was read by a clock of its own. The difference is noise of every
channel that changes, and more: a velocity that is a difference over a false interval is too large on average, by
:math:`1 + \overline{\epsilon^2}` where the interval is wrong by a share ε. With stamps that wander by 16 % the inertia
came out 6 % too small, without any sign of it.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.recording import Recording
from fricmodels.signals.clusters import certain, clusters, slope
from fricmodels.signals.segments import BRIDGED, stretches, usual_steps

CLUSTERS = 32
"""Parts of the record whose sums are taken to be independent."""
EVEN = 1e-3
"""Intervals whose standard deviation is a thousandth of them are even."""
_PIECES, _PIECE = 16, 4096
"""A long record is tested on so many pieces of so many samples, spread over it."""
_LONG, _ABOUT = 1.4, 8
"""Factor of an interval from which samples may be missing within it, and samples on each side that tell."""
_ROUNDS = 32
_WHITE = 1.5
"""Factor by which the mean square of what an even clock leaves may exceed half that of its differences, if white."""
WHOLE = 0.2
"""Share of the usual interval within which a long one is a whole multiple of it."""
_MANY = 0.05
"""Share of the intervals from which those are many."""
_CLOCK = 63
"""Samples over which a clock that drifts is followed."""


def with_even_stamps(recording: Recording) -> Recording:
    """Return the recording with even time stamps where its own are false for certain; what of them is true stays.

    Args:
        recording: as measured.
    """
    share = _share_of_false_stamps(recording)
    if share is None:
        return recording
    time, usual = recording.time.copy(), usual_steps(recording.time, recording.run)
    for part in stretches(recording.time, recording.run):
        even = _even(recording.time[part], float(usual[min(part.start, len(usual) - 1)]))
        time[part] = even + share * (recording.time[part] - even)
    if np.any((np.diff(time) <= 0.0) & (np.diff(recording.run) == 0)):
        return recording
    return recording.with_channels(derived=False, time=time)


def unevenness(recording: Recording) -> float:
    """Return the standard deviation of the intervals over their run's median, gaps and lost samples aside.

    Longer intervals that are no multiples of the usual one are no lost samples: where they are many, all count.
    """
    steps = np.diff(recording.time) / usual_steps(recording.time, recording.run)
    steps = steps[(np.diff(recording.run) == 0) & (steps < BRIDGED)]
    lost = steps >= 1.5
    if np.count_nonzero(lost & (np.abs(steps - np.round(steps)) > WHOLE)) > _MANY * len(steps):
        lost[:] = False
    regular = steps[~lost]
    return float(np.std(regular)) if len(regular) else 0.0


def are_false(share: float, error: float, count: int) -> bool:
    """Whether less than half of what stamps claim is true, for certain; see :func:`share_explained`."""
    return certain((0.5 - share) / error, count)


def share_explained(time: Array, values: Array, joined: Mask) -> tuple[float, float, int]:
    r"""Return which share of the unevenness of stamps is when samples were taken, its error, and the clusters.

    A sample is predicted from two on each side by the cubic of even samples. What that leaves over, D, is linear:

    .. math:: D x_i = \beta\,\dot x_i\,D t_i + \text{noise}

    with :math:`\beta = 1` where the stamps are true, and 0 where the samples were even and the stamps wander. The slope
    is taken from samples outside of those five, twice, six and eight samples away, of which the one is the instrument
    of the other, so that noise does not shrink β.

    Args:
        time, values: shape (N,).
        joined: whether nothing is missing between a sample and the next one, shape (N − 1,).
    """
    size = len(time)
    breaks = np.r_[0, np.cumsum(~joined)]
    if size < 16 + 4 * CLUSTERS:
        return 0.5, np.inf, 1
    at = np.arange(8, size - 8)
    at = at[breaks[at + 8] == breaks[at - 8]]
    if len(at) < 4 * CLUSTERS:
        return 0.5, np.inf, 1
    left, uneven = (_left_by_cubic(x, at) for x in (values, time))
    near, far = ((values[at + m] - values[at - m]) / (time[at + m] - time[at - m]) * uneven for m in (6, 8))
    return slope(left, near, clusters(at, size, CLUSTERS), far)


def _left_by_cubic(x: Array, at: Index) -> Array:
    """Return what the cubic through two samples on each side leaves of the one between, all five being even."""
    return np.asarray(x[at] - (4.0 * (x[at - 1] + x[at + 1]) - x[at - 2] - x[at + 2]) / 6.0)


def _share_of_false_stamps(recording: Recording) -> float | None:
    """Return which share of the stamps' unevenness is true, where they are false for certain; else ``None``."""
    if "time" in recording.derived or not unevenness(recording) >= EVEN:
        return None
    some = _pieces(len(recording))
    time, steps = recording.time[some], np.diff(recording.time[some])
    joined = (np.diff(some) == 1) & (np.diff(recording.run[some]) == 0) & (steps < 1.5 * recording.interval)
    for channel in ("position", "velocity"):
        if channel in recording and channel not in recording.derived:
            share, error, count = share_explained(time, recording[channel][some], joined)
            if are_false(share, error, count):
                return share if share > 2.0 * error else 0.0
    return None


def _pieces(size: int) -> Index:
    if size <= _PIECES * _PIECE:
        return np.arange(size)
    starts = np.linspace(0, size - _PIECE, _PIECES).astype(np.int64)
    return np.asarray((starts[:, None] + np.arange(_PIECE)).ravel())


def _even(time: Array, interval: float) -> Array:
    """Return the even clock that stamps wander about, shape (N,): a straight line, or one that drifts slowly."""
    if len(time) < 2 * _ABOUT:
        return time
    number = np.arange(len(time)) + np.r_[0, np.cumsum(_missing(time, interval))]
    even, rate = _line(time, number)
    if number[-1] >= len(time):  # of two intervals close by it is not told which is the longer one, but by the line
        nearest = np.rint(number + (time - even) / rate).astype(np.int64)
        if np.all(np.diff(nearest) > 0):
            even, rate = _line(time, nearest)
    left = time - even
    if float(np.mean(left**2)) <= _WHITE * 0.5 * float(np.mean(np.diff(left) ** 2)) or len(time) <= _CLOCK:
        return np.asarray(even)
    from scipy.signal import savgol_filter

    return np.asarray(even + savgol_filter(left, _CLOCK, 1, mode="interp"))


def _line(time: Array, number: Index) -> tuple[Array, float]:
    """Return the straight line through stamps over the number of the sample, shape (N,), and its slope."""
    from_middle = number - number.mean()
    rate, middle = np.polyfit(from_middle, time - time[0], 1)
    return time[0] + middle + rate * from_middle, float(rate)


def _missing(time: Array, interval: float) -> Index:
    """Return how many samples are missing in each interval, shape (N − 1,), from the mean stamps on both sides of it.

    A single stamp that came late makes a long interval and then a short one, and nothing is missing.
    """
    from scipy.ndimage import maximum_filter1d

    found = np.zeros(len(time) - 1, dtype=np.int64)
    at = np.flatnonzero(np.diff(time) > _LONG * interval)
    first, middle, last = np.maximum(at + 1 - _ABOUT, 0), at + 1, np.minimum(at + 1 + _ABOUT, len(time))
    for _ in range(_ROUNDS):  # the plainest of its neighbourhood first: beside it the others are known better
        late = (time - time[0]) / interval - np.arange(len(time)) - np.r_[0, np.cumsum(found)]
        sums = np.r_[0.0, np.cumsum(late)]
        jump = (sums[last] - sums[middle]) / (last - middle) - (sums[middle] - sums[first]) / (middle - first)
        change = np.maximum(np.rint(jump).astype(np.int64), -found[at])
        size = np.zeros(len(found))
        size[at] = np.abs(jump) * (change != 0)
        plainest = (change != 0) & (size[at] >= maximum_filter1d(size, 2 * _ABOUT + 1)[at])
        if not np.any(plainest):
            break
        found[at] += np.where(plainest, change, 0)
    return found
