r"""The noise of a channel with its colour: how large it is, and how long it lasts.

The model is a sum of three stationary parts, or the error of a staircase:

.. math:: r_k = \sigma_0^2\,\delta_k + \sigma_d^2\,(2\delta_k - \delta_{|k|-1}) + \sigma_1^2\,e^{-|k|/T}

white noise, the difference of white noise (a velocity that was differenced from counts), and first-order
autoregressive noise that lasts T samples. They are told apart, and from motion, by how the mean square of fourth
differences of means over s samples grows with s. White noise falls as 1/s, its difference faster; autoregressive
noise rises at most as s, until s is T. Motion rises faster: a jump of the slope as :math:`s^3`, of the curvature as
:math:`s^5`, what is smooth as :math:`s^8`. Non-negative least squares divides what is measured between all of these.
Where motion exceeds the noise before s reaches T, only :math:`\sigma_1^2/T` is known; the longest T that fits is
taken, an upper bound, until a drive at rest tells more (:mod:`.rest`).

A quantised signal that moves slowly has errors that are neither white nor seen in differences: the signal does not
change at all for many samples. There the noise is what the same staircase makes of the smoothed signal, of standard
deviation :math:`q/\sqrt{12}`.

Source: D. W. Allan, "Statistics of atomic frequency standards", Proc. IEEE 54 (1966), with fourth differences in place
of second ones, against motion; C. L. Lawson, R. J. Hanson, "Solving least squares problems", 1974, for the division.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.signals.fourth_differences import DIFFERENCE, fourth_differences, running_sums

_SCALES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)
_ALL_SCALES = (*_SCALES, 192, 256, 384, 512)
"""Means over so many samples, and over more where there is no motion."""
_LASTING = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0)
"""Times T that are tried, in samples."""
_MOTION = (3, 5, 8)
"""Powers of s with which the mean square rises that motion causes."""
_KEPT, _KEPT_SQUARE = 0.9, 0.6233
"""The largest tenth of the squares is left out, so that a few jumps do not count; mean square of the rest, for a
normal distribution of variance 1."""
_UNTOLD = 0.05
"""White noise of less than this share of the RMS fourth difference, jumps of the motion and all, is not told from none;
so much is always reckoned with, and an exact signal is not taken to be exact to its last digit."""
_MOSTLY_MOTION = 20.0
"""Scales are of use until the mean square is so many times what a random walk would make of that of the finest one."""
_BLOCK, _QUIET = 16, 0.2
"""Where motion comes and goes, noise is told by the quietest fifth of all stretches of so many fourth differences."""
_FEWEST = 5
_COLOURED = 20.0
"""Autoregressive noise is there if it lowers n ln(sum of squares) by so much. With white noise it was below 15, with
AR 0.9 to 0.99 above 35, on 60 simulated drives; by Akaike's criterion 4 would do, were the powers of s exact."""
_NO_MORE = 2.0
"""Factor by which a mean square may be less than that of a noise by chance; white noise and a walk differ by s²."""
_LEAST_LEFT = 1e-3
"""Sum of squares, relative to what was measured, that even the best division leaves."""
_AS_GOOD = 2.0
"""Times T fit as well if n ln(sum of squares) is within this of the best: twice the logarithm of a likelihood ratio."""


@dataclass(frozen=True)
class Noise:
    """Noise of one channel.

    Attributes:
        white, difference, lasting: standard deviation of white noise, of the white noise of which a difference is in
            the channel, and of autoregressive noise, in the channel's unit.
        samples: how long the last one lasts (T).
        step, course, error: step of a quantised signal, the signal without it, and what the recorded one differs by,
            where the noise is that of a staircase.
        filtered: weights of a filter that all of it has passed.
        scale: of each sample's white noise against that of all, shape (N,), of mean square 1; ``None`` where they are
            alike.
        at_rest: the noise of a drive at rest, where it is another.
    """

    white: float
    difference: float = 0.0
    lasting: float = 0.0
    samples: float = 0.0
    step: float = 0.0
    course: Array | None = field(default=None, compare=False)
    error: Array | None = field(default=None, compare=False)
    filtered: Array | None = field(default=None, compare=False)
    scale: Array | None = field(default=None, compare=False)
    at_rest: Noise | None = field(default=None, compare=False)

    @property
    def deviation(self) -> float:
        """Standard deviation of all of it."""
        if self.filtered is not None:
            return self._before.after(self.filtered)
        if self.course is not None:
            return self.step / math.sqrt(12.0)
        return math.sqrt(self.white**2 + 2.0 * self.difference**2 + self.lasting**2)

    @property
    def slow(self) -> Noise:
        """The noise where the signal changes slowly, or not at all."""
        return self if self.at_rest is None else self.at_rest

    @property
    def is_white(self) -> bool:
        """Whether it has no colour."""
        return not self.lasting and not self.difference and self.course is None and self.filtered is None

    def covariance(self, count: int) -> Array:
        """Return its autocovariance at lags of 0 to count − 1 samples."""
        if self.filtered is not None:
            own, reach = np.correlate(self.filtered, self.filtered, "full"), len(self.filtered) - 1
            before = self._before.covariance(count + reach)
            found = np.convolve(np.concatenate([before[:0:-1], before]), own, "same")
            return np.asarray(found[len(before) - 1 :][:count])
        if self.course is not None:
            own = self._all_covariance[:count]
            return np.concatenate([own, np.zeros(count - len(own))])
        found = np.zeros(max(count, 2))
        found[:2] = self.white**2 + 2.0 * self.difference**2, -(self.difference**2)
        if self.lasting:
            found += self.lasting**2 * np.exp(-np.arange(len(found)) / self.samples)
        return found[:count]

    def after(self, weights: Array) -> float:
        """Return the standard deviation of the noise behind a filter.

        Args:
            weights: of the filter, shape (n,).
        """
        return math.sqrt(max(self.product(weights, weights), 0.0))

    def product(self, weights: Array, others: Array) -> float:
        """Return the covariance of the noise behind one filter with that behind another, both about the same sample.

        Args:
            weights, others: of the filters, each of odd length; or both of one length.
        """
        if self.filtered is not None:
            return self._before.product(np.convolve(weights, self.filtered), np.convolve(others, self.filtered))
        if self.is_white:
            apart = (len(weights) - len(others)) // 2
            return self.white**2 * float(weights[apart : apart + len(others)] @ others)
        longer, shorter = (weights, others) if len(weights) >= len(others) else (others, weights)
        both = np.correlate(longer, shorter, "full")
        lag = np.abs(np.arange(len(both)) - (len(both) - 1) // 2)
        return float(both @ self.covariance(int(lag.max()) + 1)[lag])

    def like(self, count: int, rng: np.random.Generator) -> Array:
        """Return noise as this one, shape (count,); a staircase has as many samples as its signal.

        Args:
            count: number of samples.
            rng: source of what is drawn.
        """
        if self.filtered is not None:
            return np.convolve(self._before.like(count, rng), self.filtered, "same")
        if self.course is not None:
            return _staircase(self.course, self.step, rng.uniform())
        found = self.white * rng.standard_normal(count)
        if self.scale is not None:
            found *= self.scale
        if self.difference:
            found += self.difference * np.diff(rng.standard_normal(count + 1))
        if self.lasting:
            from fricmodels.kernels.recursion import first_order

            factor = math.exp(-1.0 / self.samples)
            driving = rng.standard_normal(count)
            driving[1:] *= math.sqrt(1.0 - factor**2)
            first_order(driving, 1.0, factor, 0.0, driving)
            found += self.lasting * driving
        return found

    def lasting_as(self, square: float) -> Noise:
        """Return the same noise with another mean square, which lasts as long as its size says.

        How fast it changes from sample to sample is known best, and stays.
        """
        left = square - self.white**2 - 2.0 * self.difference**2
        if not self.lasting or left >= self.lasting**2:
            return self
        samples = max(self.samples * left / self.lasting**2, 1.0)
        return replace(self, lasting=math.sqrt(max(left, self.lasting**2 * samples / self.samples)), samples=samples)

    def at(self, index: Index) -> Noise:
        """Return the noise of some of the samples."""
        if self.scale is not None:
            return replace(self, scale=self.scale[index], at_rest=self.at_rest and self.at_rest.at(index))
        if self.course is None or self.error is None:
            return self
        return replace(self, course=self.course[index], error=self.error[index])

    @cached_property
    def _before(self) -> Noise:
        """The noise before the filter."""
        return replace(self, filtered=None)

    @cached_property
    def _all_covariance(self) -> Array:
        """Autocovariance of the staircase's error, at all lags."""
        from scipy.fft import irfft, next_fast_len, rfft

        assert self.error is not None
        size = next_fast_len(2 * len(self.error))
        power = np.abs(rfft(self.error, size)) ** 2
        return np.asarray(irfft(power, size)[: len(self.error)] / len(self.error))


def _staircase(course: Array, step: float, offset: float) -> Array:
    """Return the error of a staircase; of the mirrored signal the mirrored error."""
    if float(course.sum()) < 0.0:
        return -_staircase(-course, step, offset)
    return np.asarray(step * np.floor(course / step + offset) + step * (0.5 - offset) - course)


def coloured_noise(
    parts: Sequence[tuple[Array, Array]], *, moving: bool = True, least: bool = False, quiet: bool = False
) -> Noise:
    """Estimate the noise of a channel from what no motion does.

    Args:
        parts: time stamps and values of stretches without a gap.
        moving: whether there is motion in them.
        least: whether the shortest T that fits is taken, a lower bound, in place of the longest.
        quiet: whether only the quietest stretches count. Strokes of a few samples have fourth differences larger than
            those of the noise; where a drive rests or keeps its speed in between, that shows the noise.
    """
    sums = _sums(parts)
    squares = dict(_squares(sums, _SCALES if moving else _ALL_SCALES, quiet))
    if not squares:
        return Noise(0.0)
    scales, measured = np.array(list(squares)), np.array(list(squares.values()))
    if not measured[0] > 0.0:
        return Noise(0.0)
    own = np.array([_gains(int(s)) for s in scales])
    motion = np.array([[float(s) ** power for power in _MOTION] for s in scales])
    fixed = np.hstack([own[:, :2], motion]) if moving else own[:, :2]
    plain, plain_left = _division(fixed, measured)
    every = _joined([fourth_differences(*both, 1) for both in sums])
    untold = _UNTOLD * math.sqrt(float(every @ every) / max(len(every), 1)) / float(np.linalg.norm(DIFFERENCE))
    white = Noise(max(math.sqrt(plain[0]), untold), math.sqrt(plain[1]))
    count = len(measured)
    if count < _FEWEST or count * math.log(plain_left / _LEAST_LEFT) < _COLOURED:
        return white  # no division leaves so little that it would count
    tried = [_division(np.column_stack([fixed, own[:, 2 + i]]), measured) for i in range(len(_LASTING))]
    left = np.array([each for _, each in tried])
    if count * math.log(plain_left / left.min()) < _COLOURED:
        return white
    fits = np.flatnonzero(count * np.log(left / left.min()) < _AS_GOOD)
    i = int(fits[0 if least else -1]) if moving else int(np.argmin(left))
    chosen = tried[i][0]
    return Noise(max(math.sqrt(chosen[0]), untold), math.sqrt(chosen[1]), math.sqrt(chosen[-1]), _LASTING[i])


def may_be_there(noise: Noise, parts: Sequence[tuple[Array, Array]]) -> bool:
    """Whether a channel may have a noise: whether at every s it alone has no more than the mean square that is there.

    Motion adds to the noise, and takes nothing away.

    Args:
        noise: white, the difference of white, and lasting.
        parts: time stamps and values of stretches without a gap.
    """
    variances = np.array([noise.white**2, noise.difference**2, noise.lasting**2])
    squares = _squares(_sums(parts), _SCALES, quiet=False)
    return all(_gains(s, noise.samples)[[0, 1, -1]] @ variances <= _NO_MORE * square for s, square in squares)


def most_noise(parts: Sequence[tuple[Array, Array]]) -> float:
    """Return the standard deviation of noise if all that happens from sample to sample in quiet stretches is noise.

    Args:
        parts: time stamps and values of stretches without a gap.
    """
    squares = dict(_squares(_sums(parts), (1,), quiet=True))
    return math.sqrt(squares.get(1, 0.0)) / float(np.linalg.norm(DIFFERENCE))


def _sums(parts: Sequence[tuple[Array, Array]]) -> list[tuple[Array | None, Array]]:
    """Return the running sums of each part that is long enough for a fourth difference."""
    return [running_sums(*part) for part in parts if len(part[0]) > 4]


def _squares(
    sums: Sequence[tuple[Array | None, Array]], scales: Sequence[int], quiet: bool
) -> Iterator[tuple[int, float]]:
    """Yield s and the mean square of fourth differences of means over s samples, without the largest.

    Or, if ``quiet``, what it is by the quietest stretches, were all of them as quiet; those in which nothing changes
    tell nothing.
    """
    finest = 0.0
    for count, scale in enumerate(scales):
        each = [fourth_differences(*both, scale) for both in sums if len(both[1]) > 5 * scale]
        for differences in each:
            differences *= differences
        if int(_KEPT * sum(map(len, each))) < 40:
            break
        value = _of_quietest(each, scale) if quiet else mean_square(_joined(each))
        if value <= 0.0 or (count >= _FEWEST and value > _MOSTLY_MOTION * finest * scale):
            break
        finest = finest or value
        yield scale, value


def _joined(parts: Sequence[Array]) -> Array:
    """Return one array of several; where there is one, that one."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts) if parts else np.zeros(0)


def mean_square(squares: Array) -> float:
    """Return the mean of squares of normal numbers without regard to the largest tenth, as jumps are few.

    They are added in their own order, not in that of a partition, which differs from processor to processor.
    """
    kept = int(_KEPT * len(squares))
    largest = float(np.partition(squares, (kept - 1, kept))[kept - 1])
    below = squares[squares < largest]
    return (float(below.sum()) + (kept - len(below)) * largest) / max(kept, 1) / _KEPT_SQUARE


def _of_quietest(squares: Sequence[Array], scale: int) -> float:
    """Return the mean square that noise has whose quietest stretches are as quiet as those of a signal."""
    means = [_stretch_means(each) for each in squares if len(each) >= _BLOCK]
    every = _joined(means)
    every = every[every > 0.0]
    return float(np.quantile(every, _QUIET)) / _quietest_of_noise(scale) if len(every) else 0.0


def _stretch_means(squares: Array) -> Array:
    """Return the means over so many of the squares, of each stretch: twice as long a sum is that of two."""
    sums, reach = squares, 1
    while reach < _BLOCK:
        sums = sums[:-reach] + sums[reach:]
        reach *= 2
    sums /= _BLOCK
    return sums


@lru_cache(maxsize=len(_ALL_SCALES))
def _quietest_of_noise(scale: int) -> float:
    """Return the mean square of the quietest stretches of white noise, of that of all."""
    noise = np.random.default_rng(0).standard_normal(40 * _BLOCK * scale + 4000)
    squares = fourth_differences(*running_sums(np.arange(float(len(noise))), noise), scale) ** 2
    return float(np.quantile(_stretch_means(squares), _QUIET) / squares.mean())


@lru_cache(maxsize=4 * len(_ALL_SCALES))
def _gains(scale: int, *times: float) -> Array:
    """Return what unit noise of each kind adds to the mean square: white, difference of white, each lasting T."""
    weights = np.repeat(DIFFERENCE / scale, scale)
    products = np.correlate(weights, weights, "full")[len(weights) - 1 :]
    lag = np.arange(len(weights))
    of_difference = 2.0 * products[0] - 2.0 * (products[1] if len(products) > 1 else 0.0)
    lasting = [products[0] + 2.0 * float(products[1:] @ np.exp(-lag[1:] / t)) for t in times or _LASTING]
    return np.array([products[0], of_difference, *lasting])


def _division(columns: Array, measured: Array) -> tuple[Array, float]:
    """Return the parts that explain what was measured, each relative to it, and the sum of squares that is left."""
    from scipy.optimize import nnls

    unit = float(measured[0])
    relative = columns / (measured / unit)[:, None]
    size = np.linalg.norm(relative, axis=0)
    found, left = nnls(relative / size, np.ones(len(measured)))
    return found / size * unit, left**2 + _LEAST_LEFT
