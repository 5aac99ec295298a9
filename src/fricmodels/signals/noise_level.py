"""How noisy and how coarse a signal is, and how much smoothing that asks for."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Hashable
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.signals.lanczos import DEGREE, even_weights, fit_stretch, lanczos_derivative
from fricmodels.signals.noise_colour import Noise, coloured_noise
from fricmodels.signals.segments import Runs, is_even, stretches

Found = TypeVar("Found")

_EXCERPT = 2048
_ENOUGH = 16 * _EXCERPT
"""Samples from which a width is chosen: more would hardly change it."""
_WIDEST = 256
"""Half width of the widest filter that is tried."""
_SHORTEST = 8
"""Samples of a stretch that says anything of noise."""

_TELLING = 32
"""Distances of which half are multiples on any grid, and one in ten by chance."""
_NEAREST = 1.2
"""Factor of the smallest distance within which others are the same one, but for rounding."""
_OFF_THE_EDGE = 1e-3
"""Share of a step by which comparisons are moved off its half and its whole, on which means of few rounded values lie:
their last digits decide nothing then."""
_OUTSIDE, _OFTEN = 0.75, 1e-3
"""Rounding leaves at most half a step. A course is too smooth if one sample in a thousand is off by three quarters."""
_SPELLING = 0.02
"""Share of the median distance between different values up to which two are one, written with other digits."""
_FINEST = 1e-8
"""Values that differ by less than this share of their median size are the same one: no sensor has finer steps, and one
value that is far too large, as of a run that diverges, does not make all others the same."""


def quantum(values: Array) -> float:
    """Return the step of a quantised signal, or 0 if its values stand on no grid.

    The smallest distance between different values is the step, or a half or a third of it, if nearly all distances are
    multiples of that: what was rounded to a coarse grid and then to a fine one has values two and three fine steps
    apart. A coarse grid that was written with few digits has each value in two or three spellings: where they lie far
    closer to each other than to the others they are one.
    """
    return _once(values, "step", lambda: _quantum(values))


def _quantum(values: Array) -> float:
    distinct = np.unique(values)
    distance = np.diff(distinct)
    rounding = _FINEST * float(np.median(np.abs(distinct))) if len(distinct) else 0.0
    distance = distance[distance > rounding]
    if len(distance) < 2:
        return float(distance[0]) if len(distance) else 0.0
    apart = np.r_[True, np.diff(distinct) > _SPELLING * float(np.median(distance))]
    if np.count_nonzero(apart) < min(len(distinct), len(distance) + 1):
        first = np.flatnonzero(apart)
        coarse = _step(np.diff(np.add.reduceat(distinct, first) / np.diff(np.r_[first, len(distinct)])))
        if coarse:
            return _refined(coarse, np.diff(distinct))
    step = _step(distance)
    return _refined(step, np.diff(distinct)) if step else 0.0


def _step(distance: Array) -> float:
    """Return the step of which nearly all distances between neighbouring values are multiples; 0 if there is none.

    A distance of many steps needs a step that is known better than from the least distance: those that are at most
    twice as large as the ones before tell it, again and again, as long as most of them are multiples.
    """
    if len(distance) < 2:
        return 0.0
    least, largest = float(np.median(distance[distance <= _NEAREST * distance.min()])), float(distance.max())
    for part in (1, 2, 3):
        step, reached, on_grid = least / part, _NEAREST * least, True
        while reached < largest and on_grid:
            reached *= 2.0
            short = distance[distance <= reached]
            on_grid = len(short) < _TELLING or float(np.mean(_is_multiple(short, step))) > 0.5
            step = _refined(step, short)
        if on_grid and np.mean(_is_multiple(distance, step)) > 0.95:
            return step
    return 0.0


def _is_multiple(distance: Array, step: float) -> Mask:
    return np.abs(distance / step - np.round(distance / step)) < 0.05


def _refined(step: float, distance: Array) -> float:
    """Return a step from the sum of the distances that are multiples of it."""
    near = distance[_is_multiple(distance, step)]
    count = float(np.round(near / step).sum())
    return float(near.sum()) / count if count else step


def noise_of(time: Array, values: Array, runs: Runs | None = None, *, least: bool = False) -> Noise:
    """Estimate the noise of a signal with its colour; see :mod:`.noise_colour`.

    Args:
        time: sample times [s], shape (N,).
        values: the signal, shape (N,).
        runs: run of each sample.
        least: whether a lasting noise is as small as it may be, or as large.
    """
    every = stretches(time, runs)
    return _once(values, (_when(time, every), least), lambda: _estimated(time, values, every, runs, least))


def _when(time: Array, every: list[slice]) -> Hashable:
    """Return what tells the instants of samples, from the first one on, and their stretches from others."""
    instants = _once(time, "instants", lambda: hash((time - time[:1]).tobytes()))
    return instants, tuple(part.start for part in every)


def _once(values: Array, asked: Hashable, find: Callable[[], Found]) -> Found:
    """Return what is found of a signal: anew only where the array is another one, or has other values."""
    key = (id(values), float(values.sum()), asked)
    known = _known.get(key)
    if known is None or known[0]() is not values:
        known = _known[key] = (weakref.ref(values, partial(_known.pop, key)), find())
    found: Found = known[1]
    return found


_known: dict[tuple[int, float, Hashable], tuple[weakref.ref[Array], Any]] = {}
"""What was found of signals that are still in use."""


def _estimated(time: Array, values: Array, every: list[slice], runs: Runs | None, least: bool) -> Noise:
    parts = [part for part in _excerpts(every) if part.stop - part.start >= _SHORTEST]
    found = coloured_noise([(time[part], values[part]) for part in parts], least=least)
    whole = sum(part.stop - part.start for part in parts) == len(values)
    seen = values if whole else np.concatenate([values[part] for part in parts] or [np.zeros(0)])
    unseen = finest_noise(seen) ** 2 - found.deviation**2
    if unseen > 0.0:
        found = replace(found, white=math.sqrt(found.white**2 + unseen))
    step = quantum(seen)
    finest = math.sqrt(found.white**2 + found.difference**2 + found.lasting**2)
    if not step or finest >= step / math.sqrt(12.0):
        return found
    plain = Noise(step / math.sqrt(12.0))
    width = best_half_width(time, values, runs, noise=plain)
    between = np.concatenate([_between_steps(values[part], step) for part in stretches(time, runs)])
    course, _ = lanczos_derivative(time, between, width, runs)
    # A course that follows the steps hides how long their errors last: it is as smooth as rounding allows.
    while (width := max(width + 1, width * 5 // 4)) <= _WIDEST:
        smoother, _ = lanczos_derivative(time, between, width, runs)
        if np.mean(np.abs(values - smoother) > _OUTSIDE * step) > _OFTEN:
            break
        course = smoother
    error = values - course
    # Where steps come as fast as samples, that is what smoothing changed of the motion: there it is rounded anew.
    fast = np.abs(np.gradient(course)) > (1.0 + _OFF_THE_EDGE) * step
    error[fast] = (error - step * np.floor(error / step + 0.5 + _OFF_THE_EDGE))[fast]
    return replace(plain, step=step, course=course, error=error)


def finest_noise(values: Array) -> float:
    r"""Return the noise of the finest steps a sensor has, :math:`q/\sqrt{12}`: no samples are true to more digits."""
    size = float(np.median(np.abs(values))) if len(values) else 0.0
    return _FINEST * size / math.sqrt(12.0) if math.isfinite(size) else 0.0


def _between_steps(values: Array, step: float) -> Array:
    """Return a quantised signal as straight lines between the instants at which it passed from one step to another."""
    passed = np.flatnonzero(np.abs(np.diff(values)) > 0.5 * step)
    if not len(passed):
        return values
    return np.interp(np.arange(len(values)), passed + 0.5, 0.5 * (values[passed] + values[passed + 1]))


def noise(time: Array, values: Array, runs: Runs | None = None) -> float:
    """Return the standard deviation of the noise on a signal; see :func:`noise_of`."""
    return noise_of(time, values, runs).deviation


def best_half_width(time: Array, values: Array, runs: Runs | None = None, *, noise: Noise | None = None) -> int:
    r"""Return the half width whose derivative has the least mean squared error, as estimated from the data.

    Against a short differentiator :math:`D_0`, which has hardly any bias, the error of :math:`D_h` is, but for a
    constant,

    .. math:: \overline{(D_h y)^2 - 2\,(D_h y)(D_0 y)} + 2\,d_h^T R\,d_0

    with the weights d and the autocovariance R of the noise (Stein's unbiased estimate of risk). First the shortest one
    serves as :math:`D_0`, then a third of the width that it led to, which is far less noisy. On uneven samples the
    weights are met by differentiating such noise. The errors of steps go with the motion: what the same two filters
    make of them stands for the last term, at the same samples. Widths are tried in steps of a quarter, on some thirty
    thousand samples spread over the record.

    Args:
        time: sample times [s], shape (N,).
        values: the signal, shape (N,).
        runs: run of each sample.
        noise: of the signal; estimated if not given.
    """
    every = stretches(time, runs)
    known = noise or noise_of(time, values, runs)
    # The noise is kept beside the width, so that no other one is taken for it.
    return _once(values, (_when(time, every), id(known)), lambda: (_half_width(time, values, every, known), known))[0]


def _half_width(time: Array, values: Array, every: list[slice], noise: Noise) -> int:
    shortest = max(1, (DEGREE + 1) // 2)
    parts = _excerpts([part for part in every if part.stop - part.start >= _SHORTEST])
    if not parts:
        return shortest
    risk = _Risk(time, values, parts, noise)
    limit = min(_WIDEST, max(part.stop - part.start for part in parts) // 8)
    first = _least(risk, shortest, shortest, limit)
    return _least(risk, first // 3, shortest, limit) if first // 3 > shortest else first


def best_smoothing(time: Array, values: Array, noise: Noise, runs: Runs | None) -> int:
    r"""Return the half width whose smoothed value has the least mean squared error.

    By :math:`\overline{(S_h y - y)^2} + 2\,s_h^T r` but for a constant, with the weights s and the autocovariance r of
    the noise. A lasting noise is as large after a wide filter as after a narrow one; there a width that is the best for
    the slope rounds off reversals and gains nothing.
    """
    parts = _excerpts([part for part in stretches(time, runs) if part.stop - part.start >= _SHORTEST])
    limit = min(_WIDEST, max((part.stop - part.start for part in parts), default=0) // 8)
    best, least, half_width = 1, np.inf, 1
    while half_width <= limit:
        left = [values[p] - fit_stretch(time[p], values[p], half_width)[0] for p in parts]
        square = sum(float(each @ each) for each in left) / sum(len(each) for each in left)
        risk = square + 2.0 * noise.product(even_weights(half_width)[0], np.ones(1))
        if risk < least:
            best, least = half_width, risk
        elif half_width > 3 * best:
            break
        half_width = max(half_width + 1, half_width * 5 // 4)
    return best


def _least(risk: _Risk, reference: int, shortest: int, limit: int) -> int:
    best, least, half_width = shortest, np.inf, max(shortest, reference)
    while half_width <= max(limit, shortest):
        value = risk(half_width, reference)
        if value < least:
            best, least = half_width, value
        elif half_width > 3 * best and not risk.of_steps:
            break
        half_width = max(half_width + 1, half_width * 5 // 4)
    return best


class _Risk:
    """The estimated squared error of the derivative, but for a constant, summed over samples."""

    def __init__(self, time: Array, values: Array, parts: list[slice], noise: Noise) -> None:
        self._time, self._parts, self._noise = time, parts, noise
        self.of_steps = noise.error is not None and len(noise.error) == len(values)
        # Where the noise is that of steps, the very errors that they make.
        self._even = [is_even(time[part]) and not self.of_steps for part in parts]
        self._slopes, self._slopes_of_noise = _Slopes(time, values, parts), None
        if noise.error is not None and self.of_steps:
            self._slopes_of_noise = _Slopes(time, noise.error, parts)
        elif not all(self._even):  # always the same noise: it weighs a filter on samples of any spacing
            self._slopes_of_noise = _Slopes(time, noise.like(len(values), np.random.default_rng(0)), parts)

    def __call__(self, half_width: int, reference: int) -> float:
        total = 0.0
        weights, short_weights = (even_weights(h)[1] for h in (half_width, reference))
        shared = self._noise.product(weights, short_weights) if any(self._even) else 0.0
        for i, part in enumerate(self._parts):
            slope, short = (self._slopes(i, h) for h in (half_width, reference))
            if self._even[i] or self._slopes_of_noise is None:
                time = self._time[part]
                step = (time[-1] - time[0]) / (len(time) - 1)
                overlap = shared * len(time) / step**2
            else:
                noise, short_noise = (self._slopes_of_noise(i, h) for h in (half_width, reference))
                overlap = float(noise @ short_noise)
            total += float(slope @ (slope - 2.0 * short)) + 2.0 * overlap
        return total


class _Slopes:
    """Derivatives of one signal over its parts, each width found once."""

    def __init__(self, time: Array, values: Array, parts: list[slice]) -> None:
        self._parts = [(time[part], values[part]) for part in parts]
        self._known: dict[tuple[int, int], Array] = {}

    def __call__(self, i: int, half_width: int) -> Array:
        if (i, half_width) not in self._known:
            self._known[i, half_width] = fit_stretch(*self._parts[i], half_width)[1]
        return self._known[i, half_width]


def _excerpts(parts: list[slice]) -> list[slice]:
    """Return the stretches, or excerpts spread over them where they are more samples than enough."""
    total = sum(part.stop - part.start for part in parts)
    if total <= _ENOUGH:
        return parts
    pieces = [
        slice(start, min(start + _EXCERPT, part.stop))
        for part in parts
        for start in range(part.start, part.stop, _EXCERPT)
    ]
    pieces = [piece for piece in pieces if piece.stop - piece.start >= _SHORTEST]
    count = max(1, int(_ENOUGH / total * len(pieces)))
    return [pieces[i] for i in np.unique(np.linspace(0, len(pieces) - 1, count).astype(int))]
