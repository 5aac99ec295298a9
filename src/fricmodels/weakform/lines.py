r"""Waves over position that pass faster than the test functions are wide: lines in the spectrum over position.

What a fitted model leaves of the momentum balance from sample to sample, :math:`r_i`, is regressed on
:math:`\cos kq_i` and :math:`\sin kq_i`, forward and backward apart: a torque of position, a friction that varies with
it and a ripple of the motor torque each show in both or in one of them. Its noise is not white: noise of a velocity
grows with frequency, what the model does wrong falls. An autoregression A of the residual whitens it, so that all wave
numbers are looked at by generalised least squares at once,

.. math:: s(k) = \sum_i (A^\top A\,r)_i\,e^{-\mathrm{j}kq_i}, \qquad
          \mathrm{E}|s|^2 = \sigma^2 \sum_i |A(e^{\mathrm{j}k\Delta q_i})|^2,

by one fast transform over position: the drive's own motion chooses at which frequency a wave is seen, and so against
how much noise. The largest :math:`|s|^2` is tested by a Wald test with the long-run variance of its scores, corrected
for the number of independent wave numbers, and taken out before the next is sought.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.order_spectrum import LEAST_PERIODS, PEAKS, binned, spectrum
from fricmodels.weakform.carriers import step_response
from fricmodels.weakform.long_run import cosine_terms, long_run_sum
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.steps import Steps, positions

_ORDER = 8
"""Order of the autoregression. White noise of a velocity leaves a moving average, which it comes near enough to: what
is missing costs a little power, and no false line, since significance is read from the scores."""
_MOST_LINES = 8
"""Most lines that are taken out one after the other."""
_BLOCKS = 4096
"""Scores are summed over blocks, so that no more than so many enter the long-run variance."""
_SPEEDS = 48
"""Classes of speed in which the noise of a wave number is summed."""
_OUTLIER = 4.0
"""What is farther from zero than so many standard deviations counts as being there: a shock is no wave, and would be
one of all wave numbers."""
_QUANTILE = 1.645
"""Nine tenths of a normal distribution lie within so many standard deviations; by these shocks are told."""
_STRETCH = 512
"""Wave numbers of the padded spectrum, 256 times its resolution, that are looked at as one surrounding."""
_INDEPENDENT = 16
"""Samples to an independent score, at most: as many as the narrowest test function spans."""
_ENOUGH = 16 * _INDEPENDENT
"""Least number of samples: fewer independent scores have no long-run variance to speak of."""


@dataclass(frozen=True)
class Line:
    """A wave over position.

    Attributes:
        k: wave number [1/rad or 1/m].
        torque: RMS torque of the wave [N m or N], over both directions.
        p_value: of the Wald test, corrected for the number of independent wave numbers.
    """

    k: float
    torque: float
    p_value: float


class Whitened:
    """The residual of a drive, whitened by an autoregression of itself, and tests of waves in it.

    Args:
        steps: the residual.
    """

    def __init__(self, steps: Steps) -> None:
        self.steps = steps
        series, used = steps.residual, steps.used
        covariance = np.array(
            [
                float(series[lag:] @ series[: len(series) - lag])
                / max(int(np.sum(used[lag:] & used[: len(used) - lag])), 1)
                for lag in range(_ORDER + 1)
            ]
        )
        self._filter = _prediction_error_filter(covariance)
        # A balance counts where all those before it that the filter takes are known.
        whole = np.convolve(used.astype(float), np.ones(_ORDER + 1))[: len(used)]
        self.valid = whole > _ORDER + 0.5
        self.terms = cosine_terms(float(np.sum(self.valid)) / _INDEPENDENT, max(int(np.sum(self.valid)), 9))
        place, speed = steps.place[self.valid], np.abs(steps.passed[self.valid])
        self.orders = [np.arange(len(place)), np.argsort(place), np.argsort(speed)]
        ways = steps.passed > 0, steps.passed < 0
        self.ways = [way for way in ways if np.any(way & self.valid)]
        self.set(series)

    @property
    def tells(self) -> bool:
        """Whether there are enough samples to tell a wave: where most repeat the one before there may be none."""
        return int(np.sum(self.valid)) >= _ENOUGH

    def set(self, residual: Array) -> None:
        """Take a residual, shape (N,)."""
        self.residual = residual
        white = np.where(self.valid, self.filtered(residual), 0.0)
        inside = np.abs(white[self.valid])
        limit = _OUTLIER * float(np.quantile(inside, 0.9)) / _QUANTILE if len(inside) else 0.0
        self.white = np.clip(white, -limit, limit)
        self.variance = float(np.mean(self.white[self.valid] ** 2)) if len(inside) else 0.0

    def with_residual(self, residual: Array) -> Whitened:
        """Return the same for another residual at the same samples, shape (N,)."""
        other = copy(self)
        other.set(residual)
        return other

    def filtered(self, series: Array) -> Array:
        """Return a series with what its own past predicts taken away, shape (N,) or (q, N)."""
        result = self._filter[0] * series
        for lag in range(1, len(self._filter)):
            result[..., lag:] += self._filter[lag] * series[..., : series.shape[-1] - lag]
        return np.asarray(result)

    def power(self, k: Array, *, averaged: bool = False) -> Array:
        r"""Return :math:`\sum_i |A(e^{jk\Delta q_i})|^2` over forward and backward motion, shape (ways, K).

        Args:
            k: wave numbers.
            averaged: whether times what a balance shows of a wave, see :meth:`wave`.
        """
        steps = self.steps
        speed = np.abs(steps.passed)
        edges = np.quantile(speed[self.valid], np.linspace(0.0, 1.0, _SPEEDS + 1))
        centre = 0.5 * (edges[:-1] + edges[1:])
        counts = [np.histogram(speed[self.valid & way], edges)[0] for way in self.ways]
        grid = np.linspace(0.0, np.pi, 512)
        response = np.abs(np.exp(-1j * np.outer(grid, np.arange(len(self._filter)))) @ self._filter) ** 2
        result = np.zeros((len(self.ways), len(k)))
        for passed, *count in zip(centre, *counts, strict=True):
            turned = np.abs((k * passed + np.pi) % (2 * np.pi) - np.pi)
            seen = np.interp(turned, grid, response)
            if averaged:
                seen = seen * np.sinc(0.5 * k * passed / np.pi) ** self.steps.order * (k * passed < np.pi)
            result += np.array(count)[:, None] * seen
        return result

    def scores(self, slowest: float, fastest: float) -> tuple[Array, Array, Array]:
        """Return wave numbers, the squared score over its expectation without a wave, and about the RMS torque."""
        scored = np.zeros_like(self.white)
        for lag, weight in enumerate(self._filter):
            scored[: len(scored) - lag] += weight * self.white[lag:]
        steps = self.steps
        low, bins = float(np.min(steps.place[steps.used])), binned(fastest, steps.span)
        lines = []
        for way in self.ways:
            chosen = steps.used & way
            k, line = spectrum(steps.place[chosen] - low, scored[chosen], steps.span, bins)
            lines.append(line)
        inside = (k >= slowest) & (k <= fastest)
        k = k[inside]
        power = np.maximum(self.power(k), 1e-300)
        squares = np.abs(np.array(lines)[:, inside]) ** 2
        normed = squares / np.maximum(self.variance * power, 1e-300)
        return k, normed.mean(axis=0), np.sqrt(2.0 * (squares / power**2).mean(axis=0))

    def rank(self, k: float) -> float:
        """Return the share of the wave numbers about one, half of it to one and a half, whose score is as large.

        What a model does wrong along the way has a spectrum of its own, in which no single wave number is a line.
        """
        around, power, _ = self.scores(0.5 * k, 1.5 * k)
        if not len(around):
            return 1.0
        return float(np.mean(power >= power[int(np.argmin(np.abs(around - k)))]))

    def wave(self, k: float) -> Array:
        r"""Return the columns of a wave that acts on the drive, forward and backward apart, shape (q, N).

        A balance is a mean over the interval: the wave times :math:`\sin(\theta/2)/(\theta/2)`, θ = kΔq.
        """
        half = 0.5 * k * self.steps.passed
        carried = np.abs(half) < 0.5 * np.pi
        phase = np.where(carried, np.sinc(half / np.pi) ** self.steps.order, 0.0) * np.exp(1j * k * self.steps.place)
        parts = [np.where(self.steps.used & way, part, 0.0) for way in self.ways for part in (phase.real, phase.imag)]
        return np.array(parts)

    def test(self, k: float, independent: float = 1.0) -> Line:
        """Return a line with its Wald test, by the long-run variance along time, place or speed, the least certain.

        A wave is there at all times, in all places and at all speeds. What comes again with a motion that is repeated
        has no slow part in time: an encoder errs alike in the same places, and most where its steps beat with the
        samples, at one speed.

        Args:
            k: wave number.
            independent: how many wave numbers it was chosen from.
        """
        from scipy.special import fdtrc

        columns = self.wave(k)
        seen = self.filtered(columns) * self.valid
        inverse = np.linalg.pinv(seen @ seen.T, rcond=1e-10, hermitian=True)
        theta = inverse @ (seen @ self.white)
        scores = seen * (self.white - theta @ seen)
        scores, q = scores[:, self.valid], len(theta)
        edges = np.arange(0, scores.shape[1], -(-scores.shape[1] // _BLOCKS))
        terms = min(self.terms, len(edges) - 1)
        left = max(terms - q + 1, 1)
        outcomes = []
        for order in self.orders:
            variance = inverse @ long_run_sum(np.add.reduceat(scores[:, order], edges, axis=1), terms) @ inverse
            wald = float(theta @ np.linalg.pinv(variance, rcond=1e-12, hermitian=True) @ theta)
            statistic = wald * left / (terms * q)
            outcomes.append((min(1.0, independent * float(fdtrc(q, left, max(statistic, 0.0)))), -statistic))
        p_value, _ = max(outcomes)
        share = np.array([np.mean(way[self.steps.used]) for way in self.ways])
        squares = (theta.reshape(-1, 2) ** 2).sum(axis=1) / 2.0
        return Line(k, float(np.sqrt(share @ squares)), p_value)

    def without(self, waves: Sequence[float]) -> Array:
        r"""Return the residual without some waves, shape (N,), whatever share of them stands in the torque.

        A torque that follows a wave shows it as sampled, :math:`\cos(\theta/2)` in the trapezium rule.
        """
        if not waves:
            return self.residual
        parts = []
        for k in waves:
            acting, half = self.wave(k), 0.5 * k * self.steps.passed
            parts += [acting, acting * step_response(half) ** self.steps.order]  # zero beyond half a wave
        columns = np.vstack(parts)
        seen = self.filtered(columns) * self.valid
        theta = np.linalg.pinv(seen @ seen.T, rcond=1e-10, hermitian=True) @ (seen @ self.white)
        return np.asarray(self.residual - theta @ columns)


def fast_lines(
    white: Whitened, band: tuple[float, float], significance: float, least: float
) -> tuple[tuple[Line, ...], Whitened]:
    """Return the significant waves over position within a band of wave numbers, the clearest first, and what is left.

    Args:
        white: the residual.
        band: least and greatest wave number.
        significance: corrected p-value below which a line is one.
        least: RMS torque below which a line is not looked for [N m or N].
    """
    found: list[Line] = []
    whole = white.residual
    independent = max(1.0, (band[1] - band[0]) * white.steps.span / np.pi)
    while white.tells and len(found) < _MOST_LINES and white.variance > 0:
        k, power, torque = white.scores(*band)
        peaks = _peaks(power / _background(power), torque >= least, significance / independent, len(white.ways))
        tests = (white.test(_summit(k, power, int(peak)), independent) for peak in peaks)
        line = next((test for test in tests if test.p_value < significance), None)
        if line is None:
            break
        found.append(line)
        rest = white.with_residual(whole)
        white = rest.with_residual(rest.without([each.k for each in found]))
    return tuple(found), white


def smallest_line(white: Whitened, band: tuple[float, float], level: float) -> float:
    """Return the RMS torque [N m or N] of the smallest wave that would be found wherever in a band it is; NaN if none.

    Args:
        white: the residual.
        band: least and greatest wave number.
        level: p-value that one wave number must reach.
    """
    from scipy.special import fdtri

    k, power, _ = white.scores(*band) if white.tells else (np.zeros(0), np.zeros(0), np.zeros(0))
    if not len(k):
        return float("nan")
    q = 2 * len(white.ways)
    critical = float(fdtri(q, max(white.terms - q + 1, 1), 1.0 - max(level, 1e-15)))
    shown = np.square(np.broadcast_to(white.power(k, averaged=True), white.power(k).shape))
    # A wave that leaves nothing in the samples is not seen, however large.
    per_power = np.divide(white.power(k), shown, out=np.full(shown.shape, np.inf), where=shown > 0.0)
    variance = white.variance * _background(power) * np.mean(per_power, axis=0)
    return float(np.max(np.sqrt(2.0 * critical * variance)))


def fast_band(problem: WeakFormProblem) -> tuple[float, float] | None:
    """Return the wave numbers that the samples carry and the rows do not; ``None`` where there are none.

    Half of the time a test function must pass more than a quarter period, and the samples less than half of one.
    Positions on a grid show no wave shorter than two of its steps.
    """
    if "position" not in problem.recording:
        return None
    covered = problem.test_functions.covered(len(problem.recording))
    place, passed = positions(problem)
    used = covered & (passed != 0.0)
    if int(np.sum(used)) < _ENOUGH:
        return None
    fastest = float(np.pi / max(np.median(np.abs(passed[used])), quantum(problem.recording["position"])))
    slowest = max(0.5 * fastest / problem.test_functions.width, 2 * np.pi * LEAST_PERIODS / float(np.ptp(place[used])))
    return (slowest, fastest) if fastest > slowest else None


def averaged_from(problem: WeakFormProblem) -> float:
    """Return the wave number from which on a test function passes a whole wave half the time, and averages it away."""
    band = fast_band(problem)
    return np.inf if band is None else 2.0 * band[1] / problem.test_functions.width


def _peaks(power: Array, large: Mask, level: float, ways: int) -> Index:
    """Return the highest peaks that white noise would not show, each of another stretch of wave numbers.

    A disturbance that lasts for a while at a constant speed has a wave number, too, and many peaks about it. It is no
    wave over position, which the long-run variance of the scores knows and the height of a peak does not.

    Args:
        power: mean squared score per way over its surroundings, shape (K,).
        large: where a line would have enough torque.
        level: probability below which a peak is one.
        ways: in how many directions the drive moves.
    """
    inner = large & (power >= np.roll(power, 1)) & (power >= np.roll(power, -1))
    inner[:1] = inner[-1:] = False
    inner &= _chance(power, ways) < level
    edges = np.arange(0, len(power), _STRETCH)
    best = np.array([start + int(np.argmax(np.where(inner, power, 0.0)[start : start + _STRETCH])) for start in edges])
    best = best[inner[best]]
    return np.asarray(best[np.argsort(power[best])[::-1][:PEAKS]])


def _chance(power: Array | float, ways: int) -> Array:
    """Return how likely noise shows as high a squared score, the mean over both ways, at one wave number."""
    from scipy.special import gammaincc

    return np.asarray(gammaincc(ways, ways * np.asarray(power)))


def _summit(k: Array, power: Array, best: int) -> float:
    """Return the wave number of a peak, between the grid's."""
    if not 0 < best < len(k) - 1:
        return float(k[best])
    before, here, after = power[best - 1 : best + 2]
    bend = before - 2 * here + after
    offset = 0.5 * (before - after) / bend if bend < 0 else 0.0
    return float(k[best] + offset * (k[1] - k[0]))


def _background(power: Array) -> Array:
    """Return the level from which a line stands out: the median of its surroundings, where that is above the mean."""
    edges = np.arange(0, max(len(power) - _STRETCH // 2, 1), _STRETCH)
    middle = np.array([np.median(power[start : start + _STRETCH]) for start in edges])
    return np.asarray(np.maximum(np.interp(np.arange(len(power)), edges + _STRETCH / 2, middle), 1.0))


def _prediction_error_filter(covariance: Array) -> Array:
    """Return 1, −a_1, … of the autoregression with given autocovariances, by the Yule–Walker equations."""
    from scipy.linalg import solve_toeplitz

    if covariance[0] <= 0:
        return np.array([1.0])
    ridge = covariance.copy()
    ridge[0] *= 1.0 + 1e-6
    return np.concatenate([[1.0], -solve_toeplitz(ridge[:-1], ridge[1:])])
