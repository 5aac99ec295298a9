r"""Noise that false time stamps make: it grows with the rate at which a channel changes.

A sample that was taken :math:`\delta` before or after its stamp differs by :math:`\dot x\,\delta`, so that

.. math:: \operatorname{var} = \sigma^2 + \sigma_t^2\,\dot x^2 .

Eighth differences show the noise and hardly any motion: of a sine of phase θ per sample they are :math:`\theta^8`, of
white noise :math:`\sqrt{12870}\,\sigma`. Samples are sorted by :math:`\dot x^2` into groups; the variances of these are
divided between both parts by maximum likelihood (McCullagh and Nelder 1989, chapter 8, gamma errors).
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from fricmodels.arrays import Array
from fricmodels.recording import Recording
from fricmodels.signals.noise_colour import Noise, mean_square
from fricmodels.signals.segments import stretches

_WIDTH = 9
"""Samples of an eighth difference."""
_GROUPS = 12
_LEAST = 600
"""Samples from which the groups are large enough."""
_MOST = 20_000
"""About so many differences are taken, spread over the record."""
_CERTAIN = 20.0
"""Twice the logarithm of the likelihood ratio from which the noise grows with the rate: more than chance asks for, as
neighbouring differences share samples."""
_CLEARLY = 1.2
"""Factor of the variance by which this noise must exceed what was found without regard to the rate."""
_ROUNDS = 20


def with_false_stamps(recording: Recording, noise: Noise) -> Noise:
    """Return the noise of the position, larger where it changes fast if the time stamps are seen to be false.

    At rest, and for how far a motion is smoothed, it is what it was: where the drive is slow friction has most to say.

    Args:
        recording: as measured.
        noise: of its position, found without regard to the rate.
    """
    position, squares, rates = recording["position"], [], []
    if len(position) < _LEAST:
        return noise
    every = max(1, len(position) // _MOST)
    parts = [p for p in stretches(recording.time, recording.run) if p.stop - p.start > 2 * _WIDTH]
    for part in parts:
        places, values = (sliding_window_view(each[part], _WIDTH)[::every] for each in (recording.time, position))
        squares.append(_differences(places, values) ** 2)
        rates.append(_squared_slope(places, values))
    if not squares:
        return noise
    own, slope, certain = _division(np.concatenate(squares), np.concatenate(rates))
    if not certain:
        return noise
    variance = np.full(len(position), own)
    for part in parts:
        middle = slice(part.start + _WIDTH // 2, part.stop - _WIDTH // 2)
        variance[middle] += slope * _squared_slope(
            *(sliding_window_view(each[part], _WIDTH) for each in (recording.time, position))
        )
    mean = float(np.mean(variance))
    if mean <= _CLEARLY * noise.deviation**2:
        return noise
    return Noise(float(np.sqrt(mean)), scale=np.sqrt(variance / mean), at_rest=noise)


def _squared_slope(time: Array, values: Array) -> Array:
    """Return the squared slope from the first to the last sample of each window, shape (windows,)."""
    return np.asarray(((values[:, -1] - values[:, 0]) / (time[:, -1] - time[:, 0])) ** 2)


def _differences(time: Array, values: Array) -> Array:
    """Return the divided eighth difference of each window, scaled so that unit white noise has unit variance."""
    apart = time[:, :, None] - time[:, None, :]
    apart[:, np.arange(_WIDTH), np.arange(_WIDTH)] = np.median(np.diff(time[0]))
    weights = 1.0 / apart.prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1)[:, None]
    return np.asarray(np.einsum("ij,ij->i", weights, values))


def _division(squares: Array, rates: Array) -> tuple[float, float, bool]:
    """Return the variance at rest, its slope over the squared rate, and whether the slope is certain."""
    from scipy.optimize import nnls

    groups = np.array_split(np.argsort(rates, kind="stable"), _GROUPS)
    size = np.array([len(group) for group in groups], dtype=float)
    level = np.array([mean_square(squares[group]) for group in groups])
    rate = np.array([float(np.mean(rates[group])) for group in groups])
    if not (np.all(level > 0.0) and rate[-1] > 0.0):
        return 0.0, 0.0, False
    constant = float(size @ level / size.sum())
    variance = np.full(_GROUPS, constant)
    for _ in range(_ROUNDS):  # Fisher scoring for gamma errors is least squares, weighted anew each time
        weight = np.sqrt(size) / variance
        found, _ = nnls(np.stack([weight, weight * rate / rate[-1]], axis=1), weight * level)
        own, slope = max(float(found[0]), 1e-12 * constant), float(found[1]) / rate[-1]
        variance = own + slope * rate
    gain = float(size @ (np.log(constant) + level / constant - np.log(variance) - level / variance))
    return own, slope, gain > _CERTAIN
