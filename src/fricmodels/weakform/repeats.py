r"""Where a motion repeats what it did before.

Robots are excited with Fourier series that go round several times, machines run their cycle, a sine is one period again
and again. Noise is new each time. What a model gets wrong is not: the same motion makes the same error, and its
repetitions say nothing new. A variance that is estimated along the record takes them for so many independent events,
since between the multiples of the repetition rate a periodic error has no power: the square of a statistic is as many
times too large as the motion repeats. So samples are told by the *phase*, at which instant of what repeats they were
taken; see :class:`fricmodels.weakform.regression.Regression`.

The correlation of the velocity with itself a lag l later,

.. math:: c(l) = \frac{\sum_i v_i v_{i+l}}{\sqrt{\sum_i v_i^2 \sum_i v_{i+l}^2}},

is near 1 at each multiple of a period P. The largest one below half the record tells whether the motion repeats to the
end; P is the smallest part of that lag of which all multiples repeat it. Runs that move alike are one motion, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.once import once
from fricmodels.recording import RUN, Recording
from fricmodels.signals.rest import smoothed_velocity

_REPEATS = 0.98
"""Correlation from which on a motion repeats another one: all but a twenty-fifth of its square is the same. The Fourier
series, cycles and sines of logs have 0.994 to 1; two runs of one trajectory under other gains 0.92 and 0.96."""
_BEGINNING = 6
"""Part of each run from its beginning, when a drive comes up to its motion, that does not count: one in so many."""
_POINTS = 1 << 14
"""Means over so many parts of all the time are correlated: fewer than rows are wide, and more than these are many."""
_FEWEST = 8
"""Points of a period."""
_DIGITS = 9
"""Of a correlation: two that differ by less are the same one, on any processor."""


@dataclass(frozen=True)
class Phase:
    """When within what repeats each sample was taken.

    Attributes:
        time: since the beginning of what repeats [s], shape (N,).
        motion: number of the motion, alike where the same motion repeats, shape (N,).
        period: of a motion that repeats within a run [s]; ``None`` where runs alone repeat.
    """

    time: Array
    motion: Index
    period: float | None


@dataclass(frozen=True)
class _Course:
    """The velocity of one run in means over even steps: its sum in each, and how many samples there are."""

    begin: float
    total: Array
    count: Array

    @property
    def mean(self) -> Array:
        return self.total / np.maximum(self.count, 1)

    @property
    def beginning(self) -> Mask:
        return np.arange(len(self.total)) < len(self.total) // _BEGINNING


def parts_of(recording: Recording, centre: Index, width: float) -> Index | None:
    """Return which part of what repeats each row lies in, numbered without gaps; ``None`` where no motion repeats.

    Args:
        recording: with ``velocity``.
        centre: index of the sample at the middle of each row, shape (rows,).
        width: of a part, in samples.
    """
    phase = phase_of(recording)
    if phase is None:
        return None
    index = np.clip(centre, 0, len(recording) - 1)
    place = np.floor(phase.time[index] / (width * recording.interval)).astype(np.int64)
    _, part = np.unique(phase.motion[index] * (place.max(initial=0) + 1) + place, return_inverse=True)
    return np.asarray(part, dtype=np.int64)


def period_of(recording: Recording) -> float | None:
    """Return the period [s] of a motion that repeats within a run; ``None`` where it does not."""
    phase = phase_of(recording)
    return None if phase is None else phase.period


@once
def phase_of(recording: Recording) -> Phase | None:
    """Return when within what repeats each sample was taken; ``None`` where no motion repeats.

    Args:
        recording: with ``velocity``.
    """
    velocity = smoothed_velocity(recording)[0]
    of_whole = recording.signal(RUN)
    runs = [np.flatnonzero(of_whole == number) for number in np.unique(of_whole)]
    whole = sum(float(np.ptp(recording.time[run])) for run in runs)
    step = max(whole / _POINTS, recording.interval)
    if not whole > 0.0:
        return None
    velocity = velocity - float(np.mean(velocity))
    courses = [_course(recording.time[run], velocity[run], step) for run in runs]
    period = _period(courses)
    time, motion = np.empty(len(recording)), np.empty(len(recording), dtype=np.int64)
    seen: list[Array] = []
    for run, course in zip(runs, courses, strict=True):
        own = recording.time[run] - course.begin
        profile = course.mean if period is None else _folded(course, period)
        number, shift = _alike(profile, seen, turning=period is not None)
        if number == len(seen):
            seen.append(profile)
        time[run] = own if period is None else np.mod(own + shift * period / len(profile) * step, period * step)
        motion[run] = number
    if period is None and len(seen) == len(runs):
        return None
    return Phase(time, motion, None if period is None else period * step)


def _course(time: Array, velocity: Array, step: float) -> _Course:
    place = np.floor((time - time[0]) / step).astype(np.int64)
    total = np.bincount(place, weights=velocity).astype(float)
    return _Course(float(time[0]), total, np.bincount(place).astype(float))


def _period(courses: list[_Course]) -> float | None:
    """Return the period of a motion in steps; ``None`` where it does not repeat within a run."""
    most = max(len(course.total) for course in courses) // 2
    correlation = _correlation(courses, most)
    turned = np.flatnonzero(correlation < 0.0)
    if not len(turned) or most < 2 * _FEWEST:
        return None
    begin = max(int(turned[0]), most // 2)
    last = begin + int(np.flatnonzero(correlation[begin:] == correlation[begin:].max())[-1])
    if correlation[last] < _REPEATS:
        return None
    for parts in range(last // max(int(turned[0]), _FEWEST), 0, -1):
        lags = np.rint(last / parts * np.arange(1, parts + 1)).astype(np.int64)
        if np.all(correlation[lags] >= _REPEATS):
            return last / parts
    return float(last)


def _correlation(courses: list[_Course], most: int) -> Array:
    """Return the correlation at lags of 0 to ``most`` steps, shape (most + 1,), of all runs together."""
    from scipy.fft import irfft, next_fast_len, rfft

    size = next_fast_len(2 * max(len(course.total) for course in courses))
    product, late = np.zeros((2, size))
    for course in courses:
        there = (course.count > 0) & ~course.beginning
        velocity = course.mean * there
        value, square, mask = (rfft(x.astype(float), size) for x in (velocity, velocity**2, there))
        product += irfft(np.conj(value) * value, size)
        late += irfft(np.conj(mask) * square, size)
    power = np.roll(late[::-1], 1) * late  # the squares before a lag are those behind its negative
    found = np.divide(product, np.sqrt(np.maximum(power, 0.0)), out=np.zeros(size), where=power > 1e-18 * power[0])
    return np.asarray(np.round(found[: most + 1], _DIGITS))


def _folded(course: _Course, period: float) -> Array:
    """Return the mean velocity at each phase, shape (period in steps,)."""
    parts = max(int(period), 1)
    phase = np.mod(np.arange(len(course.total)) + 0.5, period) * parts / period
    place = np.minimum(phase.astype(np.int64), parts - 1)
    total, count = (
        np.bincount(place, weights=x * ~course.beginning, minlength=parts) for x in (course.total, course.count)
    )
    return np.asarray(total / np.maximum(count, 1))


def _alike(profile: Array, seen: list[Array], *, turning: bool) -> tuple[int, int]:
    """Return the number of the course that one repeats, or the next number, and by how many parts it is behind."""
    for number, other in enumerate(seen):
        shift, correlation = _best_shift(profile, other, turning=turning)
        if correlation >= _REPEATS:
            return number, shift
    return len(seen), 0


def _best_shift(profile: Array, other: Array, *, turning: bool) -> tuple[int, float]:
    """Return the shift at which one course repeats another one best, and their correlation there.

    Args:
        profile, other: mean velocities.
        turning: whether they are periodic; else they begin together, and are compared as far as both go.
    """
    shared = min(len(profile), len(other))
    begin = 0 if turning else shared // _BEGINNING
    one, two = profile[begin:shared], other[begin:shared]
    size = float(np.sqrt((one @ one) * (two @ two)))
    if not size > 0.0 or (not turning and 2 * shared < max(len(profile), len(other))):
        return 0, 0.0
    if not turning:
        return 0, float(one @ two) / size
    products = np.fft.irfft(np.conj(np.fft.rfft(one)) * np.fft.rfft(two), len(one))
    shift = int(np.argmax(np.round(products / size, _DIGITS)))
    return shift, float(products[shift]) / size
