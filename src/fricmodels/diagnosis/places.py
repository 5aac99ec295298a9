r"""Where along a channel a residual has a mean that noise alone would not have.

A predictor of few basis functions over a whole channel cannot show what happens in one place: a bump at one position is
passed for a moment in each cycle, so that a test over blocks of time sees a few large values and no order in them. Here
the rows are sorted into bins of a channel, and each *pass* through a bin is one observation. With the sums :math:`S_p`
of the residual over pass p, and :math:`N_p` rows in it,

.. math:: m = \frac{\sum_p S_p}{\sum_p N_p}, \qquad
          s^2 = \frac{n}{n-1} \frac{\sum_p (S_p - N_p m)^2}{(\sum_p N_p)^2},

(Liang and Zeger 1986, means of clusters). Rows of one pass may depend on each other in any way; passes are taken for
independent. A bin is passed a few times only, so that its own spread is uncertain. How far the spreads of bins differ
beyond that tells how much all of them together say of one (moderated t, Smyth 2004): with :math:`d = n - 1`, and
:math:`d_0, s_0^2` from the mean and the variance of :math:`\log s^2` over all bins,

.. math:: \tilde s^2 = \frac{d_0 s_0^2 + d s^2}{d_0 + d}, \qquad m / \tilde s \sim t_{d_0 + d}.

Bins with like noise, :math:`d_0 \to \infty`, share one spread; where noise goes with the channel each bin has its own,
and a few passes prove little. p-values are corrected for all bins (Bonferroni).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.diagnosis.candidate_tests import CandidateTests
from fricmodels.diagnosis.policy import Policy
from fricmodels.results.words import ALONG
from fricmodels.weakform.acting import acting
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.regression import LEAST_P, Regression

_BINS = 32
"""Bins of equally many rows over a channel."""
_LEAST_PASSES = 2
"""A bin that was passed less often has no spread of its own."""


@dataclass(frozen=True)
class Place:
    """A stretch of a channel in which the residual has a mean of one sign.

    Attributes:
        channel: position, speed or load torque.
        direction: forward, backward, both, or along the motion: both, with the sign of the motion.
        low, high: ends of the stretch, in the unit of the channel.
        torque: mean residual there [N m or N]; along the motion for speed, and where the direction says so.
        passes: the least number of passes through one of its bins.
        p_value: least of its bins, corrected for all bins of all channels.
        share: share of the squared residual that the means of its bins explain.
    """

    channel: str
    direction: str
    low: float
    high: float
    torque: float
    passes: int
    p_value: float
    share: float


def places(problem: WeakFormProblem, regression: Regression, policy: Policy) -> list[Place]:
    """Return the places whose means are significant, the one that explains most of the residual first.

    Args:
        problem: the fitted model and its rows.
        regression: whose residual is looked at.
        policy: the level of significance.
    """
    views = list(_views(problem, regression.residual))
    trials = sum(view.bins for view in views)
    found = [place for view in views for place in view.significant(policy.significance / max(trials, 1), trials)]
    return sorted(found, key=lambda place: -place.share)


def largest_place(result: CandidateTests) -> Place | None:
    """Return the place that explains most, if what it explains is large enough to count; see ``least_torque``."""
    found = places(result.problem, result.regression, result.policy)
    large = bool(found) and torque_of(found[0], result) > 100 * result.policy.least_torque
    return found[0] if large else None


def torque_of(place: Place, result: CandidateTests) -> float:
    """Return the RMS torque that the means of a place's bins explain, in % of the RMS torque."""
    torque = acting(result.problem)
    squares = place.share * float(result.regression.residual @ result.regression.residual)
    return 100 * float(np.sqrt(squares / (torque @ torque)))


@dataclass(frozen=True)
class Profile:
    """The mean residual in bins of a channel.

    Attributes:
        channel, direction: as of a :class:`Place`.
        at, torque, error: middle of each bin, its mean residual [N m or N] and the standard error of that, shape (k,).
    """

    channel: str
    direction: str
    at: Array
    torque: Array
    error: Array


def profile(result: CandidateTests, channel: str, direction: str = "both") -> Profile | None:
    """Return the mean residual over a channel; ``None`` where the recording has no such channel, or hardly moves in it.

    Args:
        result: the tests of a model's residual.
        channel: position, speed or load_torque.
        direction: as of a :class:`Place`.
    """
    for view in _views(result.problem, result.regression.residual):
        if (view.channel, view.direction) == (channel, direction) and view.bins > 1:
            return view.profile()
    return None


def _views(problem: WeakFormProblem, residual: Array) -> Iterator[_View]:
    recording, ones = problem.recording, np.ones((1, len(problem.recording)))
    weight = problem.test_functions.integrals(ones)[0]

    def at_rows(values: Array) -> Array:
        return np.asarray(problem.test_functions.integrals(values[None])[0] / weight)

    torque = residual / (weight * recording.interval * at_rows(relative_intervals(recording)))
    if problem.test_functions.counts is not None:
        torque = torque / at_rows(problem.test_functions.counts)
    velocity = at_rows(problem.smooth)
    moving_on = np.abs(velocity) >= 0.999 * at_rows(np.abs(problem.smooth))  # rows without a reversal
    forward, backward = moving_on & (velocity > 0), moving_on & (velocity < 0)
    moving, along = forward | backward, torque * np.sign(velocity)
    for name, values in {"position": torque, "load_torque": torque}.items():
        if name in recording and np.ptp(recording[name]) > 0:
            at = at_rows(recording[name])
            for direction, mask in (("both", moving), ("forward", forward), ("backward", backward)):
                yield _View(name, direction, at, values, mask, problem)
            yield _View(name, ALONG, at, along, moving, problem)
    speed = np.abs(velocity)
    yield _View("speed", "both", speed, along, moving, problem)
    yield _View("speed", "forward", speed, torque, forward, problem)
    yield _View("speed", "backward", speed, torque, backward, problem)


class _View:
    """Rows sorted into bins of a channel.

    Args:
        channel, direction: see :class:`Place`.
        at: value of the channel at each row, shape (M,).
        torque: mean residual of each row [N m or N], shape (M,).
        mask: the rows that count, shape (M,).
        problem: gives the rows' places in time.
    """

    def __init__(
        self, channel: str, direction: str, at: Array, torque: Array, mask: Mask, problem: WeakFormProblem
    ) -> None:
        self.channel, self.direction = channel, direction
        self._total = float(torque @ torque) or 1.0
        chosen = np.flatnonzero(mask)
        self._edges = np.unique(np.quantile(at[chosen], np.linspace(0, 1, _BINS + 1))) if len(chosen) else np.zeros(1)
        self.bins = max(len(self._edges) - 1, 0)
        if not self.bins:
            return
        label = np.clip(np.searchsorted(self._edges, at[chosen], side="right") - 1, 0, self.bins - 1)
        self._passes(label, torque[chosen], problem.centre[chosen], problem.test_functions.width)

    def _passes(self, label: Index, torque: Array, centre: Index, width: int) -> None:
        """Sum the residual over each pass; rows of a bin within a test function's width are of one pass."""
        order = np.lexsort((centre, label))
        label, torque, centre = label[order], torque[order], centre[order]
        new = np.concatenate([[True], (np.diff(label) != 0) | (np.diff(centre) > width)])
        number = np.cumsum(new) - 1
        sums, rows = np.bincount(number, torque), np.bincount(number).astype(float)
        bin_of = label[new]
        self._count = np.bincount(bin_of, minlength=self.bins)
        total, members = (np.bincount(bin_of, values, minlength=self.bins) for values in (sums, rows))
        self._mean = total / np.maximum(members, 1.0)
        spread = np.bincount(bin_of, (sums - rows * self._mean[bin_of]) ** 2, minlength=self.bins)
        squares = np.maximum(np.bincount(bin_of, rows**2, minlength=self.bins), 1.0)
        variance, self._freedom = moderated(spread / squares, self._count - 1)
        self._error = np.sqrt(variance * squares) / np.maximum(members, 1.0)
        self._members = members

    def profile(self) -> Profile:
        """Return the mean of every bin."""
        middle = 0.5 * (self._edges[:-1] + self._edges[1:])
        return Profile(self.channel, self.direction, middle, self._mean, self._error)

    def significant(self, level: float, trials: int) -> Iterator[Place]:
        """Yield the stretches in which the mean has one sign, each from its first significant bin to its last."""
        from scipy.special import stdtr  # scipy.stats takes longer to import than most fits

        if not self.bins:
            return
        enough = (self._count >= _LEAST_PASSES) & (self._error > 0)
        ratio = np.divide(self._mean, self._error, out=np.zeros(self.bins), where=enough)
        p_values = np.where(enough, 2.0 * stdtr(self._freedom, -np.abs(ratio)), 1.0)
        sign = np.sign(self._mean)
        ends = np.flatnonzero(np.diff(sign)) + 1
        for stretch in np.split(np.arange(self.bins), ends):
            sure = stretch[p_values[stretch] < level]
            if not len(sure):
                continue
            start, stop = int(sure[0]), int(sure[-1]) + 1
            part = slice(start, stop)
            members = self._members[part]
            yield Place(
                self.channel,
                self.direction,
                float(self._edges[start]),
                float(self._edges[stop]),
                float(self._mean[part] @ members / members.sum()),
                int(self._count[part].min()),
                float(np.clip(p_values[part].min() * trials, LEAST_P, 1.0)),
                float(self._mean[part] ** 2 @ members / self._total),
            )


def moderated(shares: Array, freedom: Index) -> tuple[Array, Array]:
    """Return variances that borrow from each other as far as they are alike, and their degrees of freedom.

    Args:
        shares: sum of squares of each group over its number of members, shape (k,).
        freedom: degrees of freedom of each, members less one, shape (k,); a group without any takes that of all.

    Source: Smyth 2004, "Linear models and empirical Bayes methods", section 6.2.
    """
    from scipy.special import digamma, polygamma

    own = np.maximum(freedom, 0).astype(float)
    variance = shares * (own + 1.0) / np.maximum(own, 1.0)
    known = (own > 0) & (variance > 0)
    if np.count_nonzero(known) < 2:
        return variance, np.maximum(own, 1.0)
    half = 0.5 * own[known]
    logarithm = np.log(variance[known]) - digamma(half) + np.log(half)
    beyond = float(np.var(logarithm, ddof=1) - np.mean(polygamma(1, half)))
    if beyond <= 0.0:  # as alike as chance makes them
        pooled = float(np.sum(own * variance) / np.sum(own))
        return np.full(len(own), pooled), np.full(len(own), max(float(np.sum(own)), 1.0))
    prior = 2.0 * _inverse_trigamma(beyond)
    level = float(np.exp(np.mean(logarithm) + digamma(0.5 * prior) - np.log(0.5 * prior)))
    total = prior + own
    return (prior * level + own * variance) / total, np.minimum(total, max(float(np.sum(own)), 1.0))


def _inverse_trigamma(value: float) -> float:
    """Return x with trigamma(x) = value > 0, by Newton's method on the reciprocal, which is convex."""
    from scipy.special import polygamma

    x = 0.5 + 1.0 / value
    for _ in range(50):
        step = float(polygamma(1, x) * (1.0 - polygamma(1, x) / value) / polygamma(2, x))
        x += step
        if -step < 1e-8 * x:
            break
    return x
