"""Basis functions at an instant or a place that is sought: where they explain most of a residual.

They are the plainest other forms that an effect of the time or of the position may be taken for: a friction that
changes at once, not steadily, a torque or a friction that is there in one stretch of the way, and not as a wave, and a
torque that comes and goes in time, as that of a pump, whatever the drive does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.diagnosis.policy import Policy
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.repeats import period_of

_INSTANTS = 31
_TURNS, _PADDED = 8, 4
"""Periods within the record from which on a frequency is sought, and how much finer than its resolution."""
_KNOTS = 48
"""Places over the way at which a stretch may begin or end, as many samples between each two."""
_AT_ONCE = 4
"""Hats of which the samples are held at a time: of 48 they would be the most that a diagnosis holds."""
_TRIED, _AROUND = 12, 8
"""Peaks that are tried, and so many resolutions to either side tell whether a line of the motion stands out."""
_LONGEST = 64
"""Times as many places as rows beyond which a record is mostly gaps."""
_AS_GOOD = 1.0 - 1e-6
_LEAST_LEFT = 1e-6
"""Squared share of a column, of what the model leaves of it, below which it is in the model."""


def tents(values: Array, knots: Array, some: slice = slice(None)) -> Array:
    """Return a hat about each knot, or ``some``, at given values, shape (knots, N); zeros where there is but one."""
    knots = np.unique(knots)
    if len(knots) < 2:
        return np.zeros((1, len(values)))
    every = np.eye(len(knots))[some]
    rows = np.empty((len(every), len(values)))
    for row, heights in zip(rows, every, strict=True):
        row[:] = np.interp(values, knots, heights)
    return rows


def jump(problem: WeakFormProblem, regression: Regression) -> Array:
    """Return a jump along the motion and with speed, at the one of evenly spaced instants that explains most."""
    points = problem.quadrature.recording
    time, side = points.time, np.sign(points.velocity)
    instants = np.linspace(np.min(time), np.max(time), _INSTANTS + 2)[1:-1]
    limit = np.full(2, np.inf)

    def at(instant: float) -> Array:
        return problem.integrals(np.vstack([side, points.velocity]) * (time >= instant))

    every = [problem.integrated(("jump", t), partial(at, t)) for t in instants.tolist()]
    gains = [regression.explained(columns, -limit, limit)[0] for columns in every]
    return every[int(np.argmax(gains))]


def frequency(problem: WeakFormProblem, regression: Regression, policy: Policy) -> float:
    """Return the frequency [Hz] at which a residual has most power; 0 where none can be told.

    Not one of the motion itself: what a model gets wrong of it has these, whatever is missing. They are those at
    which it repeats, and those at which its velocity or its direction has a line.
    """
    grid = _frequencies(problem)
    if grid is None:
        return 0.0
    found = grid.power(regression.residual)
    left, energy = np.where(grid.possible, found, 0.0), float(regression.residual @ regression.residual)
    if not left.max() > policy.line_share * 0.5 * len(grid.place) * energy:
        return 0.0
    velocity = problem.smooth[grid.centre]
    motion = [(grid.power(rows), energy / float(rows @ rows)) for rows in (velocity, np.sign(velocity)) if np.any(rows)]
    for _ in range(_TRIED):
        best = int(np.argmax(left))
        near = slice(max(best - _PADDED, 0), best + _PADDED + 1)
        around = slice(max(best - _AROUND * _PADDED, 0), best + _AROUND * _PADDED + 1)
        if not left[best] > 0.0:
            break
        if not any(_has_line(scale * own, float(found[best]), near, around, policy) for own, scale in motion):
            sides = found[max(best - 1, 0) : best + 2]
            bend = sides[0] - 2.0 * sides[1] + sides[-1] if 0 < best < len(found) - 1 else 0.0
            between = 0.5 * (sides[0] - sides[-1]) / bend if bend < 0.0 else 0.0
            return float((best + between) * grid.step)
        left[near] = 0.0
    return 0.0


def frequencies_tried(problem: WeakFormProblem) -> int:
    """Return among how many frequencies that are told apart :func:`frequency` chooses."""
    grid = _frequencies(problem)
    return 0 if grid is None else int(grid.possible.sum()) // _PADDED


@dataclass(frozen=True)
class _Frequencies:
    """Frequencies over the time of rows: rows are a part of a test function apart, which gives the highest.

    Attributes:
        centre: sample in the midst of each row.
        place: number of each row on an even grid over the time.
        size: length of a transform, padded with zeros.
        step: distance of two frequencies [Hz].
        possible: those that turn often enough within the record, and at which the motion does not repeat.
    """

    centre: Index
    place: Index
    size: int
    step: float
    possible: Mask

    def power(self, rows: Array) -> Array:
        """Return the squared amplitude of rows at each frequency."""
        from scipy.fft import rfft

        return np.asarray(np.abs(rfft(np.bincount(self.place, weights=rows), self.size)) ** 2)


def _frequencies(problem: WeakFormProblem) -> _Frequencies | None:
    from scipy.fft import next_fast_len

    recording, hop = problem.recording, problem.test_functions.hop * problem.recording.interval
    centre = np.clip(problem.centre, 0, len(recording) - 1)
    time = recording.time[centre]
    place = np.rint((time - time[0]) / hop).astype(np.int64) if len(time) else np.zeros(0, dtype=np.int64)
    count = int(place[-1]) + 1 if len(place) else 0
    if count < 2 * _TURNS or count > _LONGEST * len(place) or np.any(place < 0):
        return None
    size = next_fast_len(_PADDED * count, real=True)
    step, resolution = 1.0 / (size * hop), 1.0 / (count * hop)
    each = step * np.arange(size // 2 + 1)
    possible = each >= _TURNS * resolution
    period = period_of(recording)
    if period is not None:
        turns = each * period
        possible &= np.abs(turns - np.rint(turns)) > period * resolution
    return _Frequencies(centre, place, size, step, possible)


def _has_line(power: Array, residual: float, near: slice, around: slice, policy: Policy) -> bool:
    """Whether a motion, with as much power as the residual, stands out with a line beside one of the residual."""
    most = float(power[near].max())
    beside = float(np.median(power[around]))
    return most > policy.line_of_motion * residual and most > policy.line_stands_out * beside


def in_time(problem: WeakFormProblem, frequency: float) -> Array:
    """Return the cosine and the sine of the time at a frequency [Hz], as integrals, shape (2, rows)."""
    phase = 2.0 * np.pi * frequency * problem.quadrature.recording.time
    return problem.integrals(np.vstack([np.cos(phase), np.sin(phase)]))


def stretch(problem: WeakFormProblem, regression: Regression, *, along: bool, channel: str = "position") -> Array:
    r"""Return one torque in the stretch of the way that explains most, and its two ends apart, shape (3, rows).

    With hats :math:`h_1 \dots h_K` over the position, or the time, the torque of a stretch is
    :math:`h_i + \dots + h_j`: one inside, and falling to nothing between two knots at either end. Hats at the ends have
    coefficients of their own, so that an end may lie between knots. All stretches are compared at once: the products of
    their columns with each other and with the residual are differences of running sums of those of the hats.

    Args:
        problem: the rows, of a recording with positions.
        regression: whose residual is to be explained.
        along: whether the torque is a friction, with the sign of the motion.
        channel: that the stretch is one of, ``position`` or ``time``.
    """
    hats, first, last = _best_stretch(problem, regression, along, channel)
    part = hats[first:last]
    return np.vstack([part[1:-1].sum(axis=0, keepdims=True), part[:1], part[1:][-1:]])


def ends_of_stretch(
    problem: WeakFormProblem, regression: Regression, *, along: bool, channel: str = "position"
) -> tuple[float, float]:
    """Return where the stretch of :func:`stretch` begins and ends, half-way down to nothing [rad, m or s]."""
    _, first, last = _best_stretch(problem, regression, along, channel)
    knots = _knots(problem.quadrature.recording[channel])
    middle = np.concatenate([knots[:1], 0.5 * (knots[1:] + knots[:-1]), knots[-1:]])
    return float(middle[first]), float(middle[last])


def _best_stretch(
    problem: WeakFormProblem, regression: Regression, along: bool, channel: str
) -> tuple[Array, int, int]:
    """Return hats over a channel as integrals, shape (k, rows), and the first of the stretch and the one after it."""
    hats = problem.integrated((f"hats over the {channel}", along), partial(_hats, problem, along, channel))
    knots = len(hats)
    products = regression.projected_gram(hats)
    gram = np.zeros((knots + 1, knots + 1))
    gram[1:, 1:] = np.cumsum(np.cumsum(products.gram, axis=0), axis=1)
    right = np.concatenate([[0.0], np.cumsum(hats @ regression.residual)])
    square = np.diag(gram)
    power = square[None] + square[:, None] - gram - gram.T  # of the stretch from knot i to knot j - 1
    inside = np.concatenate([[0.0], np.cumsum(np.sqrt(products.power))])
    enough = power > _LEAST_LEFT * (inside[None] - inside[:, None]) ** 2
    possible = np.triu(enough, 1)
    gain = np.where(possible, (right[None] - right[:, None]) ** 2 / np.where(possible, power, 1.0), 0.0)
    first, last = np.nonzero(possible & (gain >= _AS_GOOD * np.max(gain)))
    if not len(first):
        return hats, 0, 0
    shortest = int(np.argmin(last - first))  # all the rest of the way with the other sign may be the same
    return hats, int(first[shortest]), int(last[shortest])


def _knots(values: Array) -> Array:
    return np.unique(np.quantile(values, np.linspace(0, 1, _KNOTS)))


def _hats(problem: WeakFormProblem, along: bool, channel: str) -> Array:
    points = problem.quadrature.recording
    values, side = points[channel], np.sign(points.velocity) if along else 1.0
    knots = _knots(values)
    portions = [slice(start, start + _AT_ONCE) for start in range(0, len(knots), _AT_ONCE)]
    return np.concatenate([problem.integrals(side * tents(values, knots, some)) for some in portions])
