"""How noisy and how coarse a signal is, and how much smoothing that asks for."""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.signals.lanczos import DEGREE, even_weights, fit_stretch
from fricmodels.signals.segments import Runs, is_even, stretches

_EXCERPT = 2048
_ENOUGH = 16 * _EXCERPT
"""Samples from which a width is chosen: more would hardly change it."""

_FINEST = 1e-8
"""Values that differ by less than this share of the largest are the same one: no sensor has finer steps."""


def quantum(values: Array) -> float:
    """Return the step of a quantised signal, or 0 if its values stand on no grid.

    The smallest distance between different values is the step if nearly all distances are multiples of it.
    """
    distinct = np.unique(values)
    distance = np.diff(distinct)
    rounding = _FINEST * np.abs(distinct).max() if len(distinct) else 0.0
    distance = distance[distance > rounding]
    if len(distance) < 2:
        return float(distance[0]) if len(distance) else 0.0
    step = float(np.median(distance[distance <= 1.5 * distance.min()]))
    multiple = distance / step
    on_grid = np.mean(np.abs(multiple - np.round(multiple)) < 0.05)
    return step if on_grid > 0.95 else 0.0


def noise(time: Array, values: Array, runs: Runs | None = None) -> float:
    """Estimate the standard deviation of white noise on a smooth signal.

    From what a cubic through seven neighbours leaves over: a signal sampled finely enough leaves nothing there.
    Quantisation shows as noise too.
    """
    half_width, degree = 3, 3
    share = 1.0 - even_weights(half_width, degree)[0][half_width]
    residual, expected = 0.0, 0.0
    for part in _excerpts(stretches(time, runs)):
        if part.stop - part.start < 2 * half_width + 1:
            continue
        inner = slice(half_width, part.stop - part.start - half_width)
        rest = (values[part] - fit_stretch(time[part], values[part], half_width, degree)[0])[inner]
        residual += float(rest @ rest)
        if is_even(time[part]):
            expected += len(rest) * share
        else:
            white = _white(part)
            rest = (white - fit_stretch(time[part], white, half_width, degree)[0])[inner]
            expected += float(rest @ rest)
    return float(np.sqrt(residual / expected)) if expected else 0.0


def _white(part: slice) -> Array:
    """Return white noise for a stretch, always the same: it weighs a filter on samples of any spacing."""
    white: Array = np.random.default_rng(part.start).standard_normal(part.stop - part.start)
    return white


def best_half_width(
    time: Array, values: Array, runs: Runs | None = None, *, degree: int = DEGREE, largest: int = 256
) -> int:
    r"""Return the half width whose derivative has the least mean squared error, as estimated from the data.

    Against a short differentiator :math:`D_0`, which has hardly any bias, the error of :math:`D_h` is, but for a
    constant,

    .. math:: \overline{(D_h y)^2 - 2\,(D_h y)(D_0 y)} + 2\sigma^2\,\overline{d_h\cdot d_0}

    with the weights d and the noise σ (Stein's unbiased estimate of risk). First the shortest one serves as
    :math:`D_0`, then a third of the width that it led to, which is far less noisy. On uneven samples the weights are
    met by differentiating white noise. Widths are tried in steps of a quarter, on some thirty thousand samples spread
    over the record.
    """
    shortest = max(1, (degree + 1) // 2)
    parts = _excerpts([part for part in stretches(time, runs) if part.stop - part.start >= 8])
    if not parts:
        return shortest
    risk = _Risk(time, values, parts, noise(time, values, runs), degree)
    limit = min(largest, max(part.stop - part.start for part in parts) // 8)
    first = _least(risk, shortest, shortest, limit)
    return _least(risk, first // 3, shortest, limit) if first // 3 > shortest else first


def _least(risk: _Risk, reference: int, shortest: int, limit: int) -> int:
    best, least, half_width = shortest, np.inf, max(shortest, reference)
    while half_width <= max(limit, shortest):
        value = risk(half_width, reference)
        if value < least:
            best, least = half_width, value
        elif half_width > 3 * best:
            break
        half_width = max(half_width + 1, half_width * 5 // 4)
    return best


class _Risk:
    """The estimated squared error of the derivative, but for a constant, summed over samples."""

    def __init__(self, time: Array, values: Array, parts: list[slice], sigma: float, degree: int) -> None:
        self._parts = [(time[part], values[part]) for part in parts]
        self._even = [is_even(part_time) for part_time, _ in self._parts]
        self._white = [np.empty(0) if even else _white(part) for even, part in zip(self._even, parts, strict=True)]
        self._sigma, self._degree = sigma, degree
        self._slopes: dict[tuple[int, int], tuple[Array, Array | None]] = {}

    def __call__(self, half_width: int, reference: int) -> float:
        total = 0.0
        for i, (time, _) in enumerate(self._parts):
            slope, white = self._slope(i, half_width)
            short, short_white = self._slope(i, reference)
            if white is None or short_white is None:
                step = (time[-1] - time[0]) / (len(time) - 1)
                wide = even_weights(half_width, self._degree)[1][half_width - reference : half_width + reference + 1]
                overlap = float(wide @ even_weights(reference, self._degree)[1]) * len(time) / step**2
            else:
                overlap = float(white @ short_white)
            total += float(slope @ (slope - 2.0 * short)) + 2.0 * self._sigma**2 * overlap
        return total

    def _slope(self, i: int, half_width: int) -> tuple[Array, Array | None]:
        if (i, half_width) not in self._slopes:
            time, values = self._parts[i]
            slope = fit_stretch(time, values, half_width, self._degree)[1]
            white = None if self._even[i] else fit_stretch(time, self._white[i], half_width, self._degree)[1]
            self._slopes[i, half_width] = (slope, white)
        return self._slopes[i, half_width]


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
    pieces = [piece for piece in pieces if piece.stop - piece.start >= 8]
    count = max(1, int(_ENOUGH / total * len(pieces)))
    return [pieces[i] for i in np.unique(np.linspace(0, len(pieces) - 1, count).astype(int))]
