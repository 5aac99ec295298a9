r"""Noise that false time stamps make: it grows with the rate at which a channel changes.

A sample that was taken :math:`\delta` before or after its stamp differs by :math:`\dot x\,\delta`, so that

.. math:: \operatorname{var} = \sigma^2 + \sigma_t^2\,\dot x^2 .

Eighth differences show the noise and hardly any motion: of a sine of phase θ per sample they are :math:`\theta^8`, of
white noise :math:`\sqrt{12870}\,\sigma`. Samples are sorted by :math:`\dot x^2` into groups; the variances of these are
divided between both parts by maximum likelihood (McCullagh and Nelder 1989, chapter 8, gamma errors).
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.recording import Recording
from fricmodels.signals.noise_colour import Noise, mean_square
from fricmodels.signals.segments import is_even, stretches

_WEIGHTS = np.array([1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0])
_WIDTH = len(_WEIGHTS)
_GROUPS = 12
_LEAST = 600
"""Samples from which the groups are large enough."""
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
    rate = np.zeros(len(position))
    if len(position) < _LEAST:
        return noise
    for part in stretches(recording.time, recording.run):
        if part.stop - part.start > 2 * _WIDTH:
            rate[part] = _squared_rate(recording.time[part], position[part])
            squares.append(_differences(recording.time[part], position[part]) ** 2)
            rates.append(rate[part][_WIDTH // 2 : -(_WIDTH // 2)])
    if not squares:
        return noise
    own, slope, certain = _division(np.concatenate(squares), np.concatenate(rates))
    variance = own + slope * rate
    mean = float(np.mean(variance))
    if not certain or mean <= _CLEARLY * noise.deviation**2:
        return noise
    return Noise(float(np.sqrt(mean)), scale=np.sqrt(variance / mean), at_rest=noise)


def _squared_rate(time: Array, values: Array) -> Array:
    """Return the squared rate of change about each sample, over as many samples as a difference takes."""
    middle = np.convolve(values, np.full(3, 1.0 / 3.0), "valid")
    rate = np.pad(np.gradient(middle, time[1:-1]) ** 2, 1 + _WIDTH // 2, "edge")
    return np.convolve(rate, np.full(_WIDTH, 1.0 / _WIDTH), "valid")


def _differences(time: Array, values: Array) -> Array:
    """Return eighth differences, on uneven samples divided ones, in which unit white noise has unit variance."""
    if is_even(time):
        return np.convolve(values, _WEIGHTS / np.linalg.norm(_WEIGHTS), "valid")
    places, at = (np.lib.stride_tricks.sliding_window_view(each, _WIDTH) for each in (time, values))
    apart = places[:, :, None] - places[:, None, :]
    apart[:, np.arange(_WIDTH), np.arange(_WIDTH)] = np.median(np.diff(time))
    weights = 1.0 / apart.prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1)[:, None]
    return np.asarray(np.einsum("ij,ij->i", weights, at))


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
