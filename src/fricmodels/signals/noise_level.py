"""How noisy and how coarse a signal is, and how much smoothing that asks for."""

from __future__ import annotations

import numpy as np

from fricmodels.signals.lanczos import DEGREE, even_weights, fit_stretch
from fricmodels.signals.segments import Array, Runs, is_even, stretches

_ENOUGH = 100_000
"""Samples from which a width is chosen: more would not change it."""


def quantum(values: Array) -> float:
    """Return the step of a quantised signal, or 0 if its values stand on no grid.

    The smallest distance between different values is the step if nearly all distances are multiples of it.
    """
    distinct = np.unique(values)
    distance = np.diff(distinct)
    rounding = 4.0 * np.spacing(np.abs(distinct).max()) if len(distinct) else 0.0
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
    residual, count = 0.0, 0
    share = 1.0 - even_weights(half_width, degree)[0][half_width]
    for part in _excerpts(stretches(time, runs)):
        if part.stop - part.start >= 2 * half_width + 1:
            smooth, _ = fit_stretch(time[part], values[part], half_width, degree)
            inner = slice(part.start + half_width, part.stop - half_width)
            difference = values[inner] - smooth[half_width : len(smooth) - half_width]
            residual += float(difference @ difference)
            count += len(difference)
    return float(np.sqrt(residual / (count * share))) if count else 0.0


def best_half_width(
    time: Array, values: Array, runs: Runs | None = None, *, degree: int = DEGREE, largest: int = 256
) -> int:
    r"""Return the half width whose derivative has the least mean squared error, as estimated from the data.

    Against the shortest differentiator :math:`D_0`, which has hardly any bias, the error of :math:`D_h` is, but for a
    constant, :math:`\overline{(D_h y)^2 - 2\,(D_h y)(D_0 y)} + 2\sigma^2\,\overline{d_h\cdot d_0}` with the weights d
    and the noise σ (Stein's unbiased estimate of risk). On uneven samples the weights are met by differentiating
    white noise. Widths are tried in steps of a quarter, on at most a hundred thousand samples spread over the record.
    """
    shortest = max(1, (degree + 1) // 2)
    parts = _excerpts([part for part in stretches(time, runs) if part.stop - part.start >= 8])
    if not parts:
        return shortest
    longest = max(part.stop - part.start for part in parts)
    total = sum(part.stop - part.start for part in parts)
    sigma = noise(time, values, runs)
    step = np.concatenate([np.diff(time[part]) for part in parts])
    even = all(is_even(time[part]) for part in parts)
    interval = float(np.median(step))
    white = np.random.default_rng(0).standard_normal(len(time) if not even else 0)
    reference = even_weights(shortest, degree)[1] / interval
    rough = [fit_stretch(time[part], values[part], shortest, degree)[1] for part in parts]
    rough_white = [fit_stretch(time[part], white[part], shortest, degree)[1] for part in parts if not even]
    best, least, half_width = shortest, np.inf, shortest
    while half_width <= max(min(largest, longest // 8), shortest):
        if even:
            weights = even_weights(half_width, degree)[1][half_width - shortest : half_width + shortest + 1]
            overlap = float(weights @ reference) / interval * total
        else:
            overlap = sum(
                float(fit_stretch(time[part], white[part], half_width, degree)[1] @ slope)
                for part, slope in zip(parts, rough_white, strict=True)
            )
        risk = 2.0 * sigma**2 * overlap
        for part, slope in zip(parts, rough, strict=True):
            smooth = fit_stretch(time[part], values[part], half_width, degree)[1]
            risk += float(smooth @ (smooth - 2.0 * slope))
        if risk < least:
            best, least = half_width, risk
        elif half_width > 4 * best:
            break
        half_width = max(half_width + 1, half_width * 5 // 4)
    return best


def _excerpts(parts: list[slice]) -> list[slice]:
    """Return the stretches, or excerpts spread over them where they are more samples than enough."""
    total = sum(part.stop - part.start for part in parts)
    if total <= _ENOUGH:
        return parts
    pieces = [
        slice(start, min(start + _ENOUGH // 10, part.stop))
        for part in parts
        for start in range(part.start, part.stop, _ENOUGH // 10)
    ]
    pieces = [piece for piece in pieces if piece.stop - piece.start >= 8]
    count = max(1, int(_ENOUGH / total * len(pieces)))
    return [pieces[i] for i in np.unique(np.linspace(0, len(pieces) - 1, count).astype(int))]
