r"""Size and colour of the noise of a channel.

A signal that is sampled finely enough has nothing left in the upper half of the band after three differences, but
noise. Its power there is estimated from the periodograms of short pieces, divided by what three differences make of
white noise, :math:`|1 - e^{-i\omega}|^6`. The loudest quarter of the pieces is left out, for what happens now
and then, such as a reversal. White noise has the same power at the lower and at the upper end of that half.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from fricmodels.arrays import Array, rms
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.clusters import LEVEL, significance
from fricmodels.signals.stamps import unevenness

_LENGTH = 64
_FEWEST = 16
_OVERLAP = 1.3
"""Variance of a mean over pieces under Hann's window that overlap by half, over that of independent ones (Welch 1967:
between 1 and 19/18 for powers; more here, as a margin)."""
_MATTERS = 5e-3
"""Noise of a two hundredth of the channel's RMS, in the upper half of the band, is worth a word."""

_OF_COUNTS = 0.5
"""Share of the difference of velocity and position that the steps of the position may make: q/√12 of two samples, over
two intervals."""
_NOTED = 1e-3
_WANDERS = 0.3
"""Share of the noise that is not small any more."""


@dataclass(frozen=True)
class Noise:
    """Noise of a channel.

    Attributes:
        size: standard deviation of white noise of the same power.
        tilt: natural logarithm of the power at the lower end of a band over that at its upper end.
        error: of the tilt, from its scatter over pieces.
        pieces: their number.
    """

    size: float
    tilt: float
    error: float
    pieces: int


def channel_noise(log: Log, values: Array) -> Noise:
    """Return size and colour of the noise on a channel of the log's excerpt."""
    third = np.diff(values, 3)
    if len(third) < _FEWEST * _LENGTH:
        return Noise(0.0, 0.0, np.inf, 0)
    power = _spectra(log, third)
    if len(power) < _FEWEST:
        return Noise(0.0, 0.0, np.inf, len(power))
    angle = 2.0 * np.pi * np.arange(_LENGTH // 2 + 1) / _LENGTH
    upper = slice(_LENGTH // 4 + 1, _LENGTH // 2)
    half = power[:, upper] / (2.0 - 2.0 * np.cos(angle[upper])) ** 3
    return _tilted(half, slice(0, 5), slice(-5, None))


def difference_noise(log: Log) -> Noise:
    """Return the noise of a measured velocity from its difference to the change of the measured position.

    The motion is in both, so that the whole band from an eighth on can be looked at. The tilt is that from the second
    eighth of the band to the second half; the noise of a position falls towards low frequencies there, and cannot be
    taken for coloured noise of the velocity. But the counts of a slow drive come one by one, and their error falls with
    the frequency: where it is most of what is found, nothing is known.
    """
    position, velocity, time = log.recording["position"], log.recording.velocity, log.recording.time
    if len(time) < _FEWEST * _LENGTH:
        return Noise(0.0, 0.0, np.inf, 0)
    left = velocity[1:-1] - (position[2:] - position[:-2]) / np.where(
        time[2:] > time[:-2], time[2:] - time[:-2], np.inf
    )
    power = _spectra(log, left)
    if len(power) < _FEWEST:
        return Noise(0.0, 0.0, np.inf, len(power))
    found = _tilted(power, slice(_LENGTH // 16, _LENGTH // 8 + 1), slice(_LENGTH // 4, _LENGTH // 2 - 4))
    of_counts = log.resolution["position"] / np.sqrt(24.0) / log.recording.interval
    return found if of_counts < _OF_COUNTS * found.size else Noise(0.0, 0.0, np.inf, found.pieces)


def evidence(noise: Noise) -> float:
    """Return how sure it is that noise falls with the frequency, in standard errors."""
    return noise.tilt / noise.error if noise.error > 0 else 0.0


def _spectra(log: Log, values: Array) -> Array:
    """Return the periodograms of pieces that lie within one stretch, shape (pieces, frequencies)."""
    pieces = sliding_window_view(values, _LENGTH)[:: _LENGTH // 2]
    breaks = np.r_[0, np.cumsum(~log.joined)]
    start = np.arange(len(pieces)) * (_LENGTH // 2)
    last = np.minimum(start + _LENGTH + 2, len(breaks) - 1)
    pieces = pieces[breaks[last] == breaks[start]]
    window = np.hanning(_LENGTH + 1)[:-1]
    centred = pieces - pieces.mean(axis=1, keepdims=True)
    return np.asarray(np.abs(np.fft.rfft(centred * window, axis=1)) ** 2 / float(window @ window))


def _tilted(power: Array, low_band: slice, high_band: slice) -> Noise:
    quiet = power[np.argsort(power.sum(axis=1))[: max(_FEWEST, 3 * len(power) // 4)]]
    lower, upper = quiet[:, low_band].mean(axis=1), quiet[:, high_band].mean(axis=1)
    low, high = float(lower.mean()), float(upper.mean())
    if high <= 0.0 or low <= 0.0:
        return Noise(0.0, 0.0, np.inf, len(power))
    size = float(np.sqrt(np.median(power.mean(axis=1))))
    error = float(np.std(lower / low - upper / high)) * np.sqrt(_OVERLAP / len(quiet))
    return Noise(size, float(np.log(low / high)), error, len(quiet))


def colour(log: Log, noises: dict[str, Noise]) -> Iterator[Finding]:
    """Say where noise is not white, and matters.

    The colour of a torque's noise is only noted, at a level of a thousandth: a controller colours it by its own.

    The tilt, less that of a correlation of a tenth from sample to sample, over its error is compared with Student's t
    of the number of pieces, at the level of :data:`~fricmodels.signals.clusters.LEVEL`. The noise must be a two
    hundredth of the channel's RMS value about its mean, larger than its rounding, and than what uneven sampling makes
    of the signal.
    """
    for channel, found in noises.items():
        if channel not in ("torque", "velocity") or not np.isfinite(found.error):
            continue
        spread = float(np.std(log.short.recording[channel]))
        if (
            found.size < max((_NOTED if channel == "torque" else _MATTERS) * spread, 0.5 * log.resolution[channel])
            or found.error == 0.0
        ):
            continue
        if wanders(log, channel, found):
            continue
        chance = significance(max(abs(found.tilt) - np.log(1.1), 0.0) / found.error, found.pieces)
        if chance >= (_NOTED if channel == "torque" else LEVEL):
            continue
        low_passed = found.tilt > 0
        yield Finding(
            "filtered-torque" if channel == "torque" and low_passed else "coloured-noise",
            Severity.NOTE if channel == "torque" else Severity.WARN,
            channel,
            f"the noise of the {log.called(channel)} is not white: it {'falls' if low_passed else 'rises'} with the "
            f"frequency ({figures(np.exp(abs(found.tilt)))} : 1 in power)"
            + (", as after a low-pass filter" if low_passed else ", as after a difference")
            + (", or as its controller gives it" if channel == "torque" else ""),
            ("if it was filtered, log it unfiltered" if channel == "torque" else "log it unfiltered")
            if low_passed
            else "",
        )


def wanders(log: Log, channel: str, found: Noise) -> bool:
    """Whether uneven sampling makes of a channel's changes what may be taken for much of its noise."""
    return unevenness(log.short.recording) * rms(np.diff(log.short.recording[channel])) > _WANDERS * found.size
