"""How much of a torque error is noise of the sensors, told from what is faster than any torque that is looked for."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals import motion_noise, noise, noise_of, quantum, stretches
from fricmodels.signals.lanczos import even_weights
from fricmodels.signals.noise_colour import Noise
from fricmodels.signals.segments import is_even
from fricmodels.signals.switched import torque_noise
from fricmodels.signals.unlike_files import NoiseOfFiles

_TAPS, _CUT = 63, 0.33
"""Of the high-pass filter: it lets pass what is faster than a third of the sampling rate, and less than a hundredth of
what is slower than 0.28 of it."""
_MEAN = 0.02
"""Time over which motion is averaged [s]."""
_MEDIAN = 0.4549
"""Median of the square of a standard normal number."""
_STILL = 1e-8
"""Share of the RMS change from sample to sample below which a signal stands still: the last digits of a filter."""


def white_noise(recording: Recording, channel: str) -> float:
    """Return the standard deviation of white noise in a channel, from what is faster than a third of the sampling rate.

    A torque ripple up to a quarter of the sampling rate is no noise. The median leaves out the kinks at reversals; what
    is quantised has at least the noise of rounding. On uneven samples it is :func:`fricmodels.signals.noise`.
    """
    values, fast = recording[channel], _fast(recording, channel)
    if fast is None:
        return noise(recording.time, values, recording.run)
    return max(fast / float(np.linalg.norm(_high_pass())), quantum(values) / float(np.sqrt(12.0)))


def _fast(recording: Recording, channel: str) -> float | None:
    """Return the standard deviation of what passes the high-pass filter; ``None`` on uneven or few samples.

    Counts that stand still, as those of a drive that rests for most of a recording, say nothing of noise.
    """
    values, filtered, weights = recording[channel], [], _high_pass()
    change = np.abs(np.diff(values, prepend=values[:1]))
    changes = change > _STILL * rms(change)
    for part in stretches(recording.time, recording.run):
        if part.stop - part.start >= 2 * _TAPS:
            if not is_even(recording.time[part]):
                return None
            within = np.convolve(changes[part][1:], np.ones(len(weights) - 1), "valid") > 0.5
            filtered.append(np.convolve(values[part] - values[part.start], weights, "valid")[within])
    squares = np.concatenate(filtered) ** 2 if filtered else np.zeros(0)
    return float(np.sqrt(np.median(squares) / _MEDIAN)) if len(squares) else (0.0 if filtered else None)


def noise_like(recording: Recording, channel: str, rng: np.random.Generator) -> Array:
    """Return noise as a channel has it, with its colour, shape (N,).

    It is as large as what is faster than a third of the sampling rate says, where that is less: a ripple of the torque
    that is as fast as noise is no noise. Nor is a lasting noise of the torque that by itself would leave more than
    inertia and friction do: a torque that changes slowly looks like it.

    Args:
        recording: prepared.
        channel: its torque, or what tells its motion.
        rng: source of what is drawn.
    """
    found = motion_noise(recording) if channel in ("velocity", "position") else torque_noise(recording)
    if isinstance(found, NoiseOfFiles):
        drawn = np.zeros(len(recording))
        for number in np.unique(found.which):
            drawn[found.which == number] = noise_like(recording.select(found.which == number), channel, rng)
        return drawn
    if channel == "torque":
        if found.lasting and found.after(np.full(2 * _averaged(recording), 0.5 / _averaged(recording))) > _left(
            recording
        ):
            found = Noise(white_noise(recording, channel))  # how much is not lasting was told beside what is none
    elif channel == "acceleration":
        found = noise_of(recording.time, recording[channel], recording.run)
    drawn, fast = found.like(len(recording), rng), _fast(recording, channel)
    whole = found.after(_high_pass()) if found.course is None else 0.0
    return drawn * min(1.0, fast / whole) if fast is not None and whole > 0.0 else drawn


@lru_cache(maxsize=1)
def _high_pass() -> Array:
    """Return its weights; what a cubic through seven samples follows is taken away first, however large it is.

    An ideal high pass under a Hamming window, of gain 1 at half the sampling rate.
    """
    rest = -even_weights(3, 3)[0]
    rest[3] += 1.0
    place = np.arange(_TAPS) - (_TAPS - 1) // 2
    weights = (np.sinc(place) - 2 * _CUT * np.sinc(2 * _CUT * place)) * np.hamming(_TAPS)
    return np.convolve(weights / (weights @ np.cos(np.pi * place)), rest)


@once
def apparent_inertia(prepared: Recording) -> float:
    """Return the inertia that a recording shows by itself: by least squares beside Coulomb and viscous friction.

    It weighs the noise of the motion, the same for every model. From means of 20 ms: velocities are differentiated from
    one to the next, torques and friction are the mean of both. What noise adds to the square of the acceleration is
    taken off; where nothing remains the inertia is infinite, as far as can be told.
    """
    torque, columns = _means(prepared)
    if not len(torque):
        return 0.0
    gram = columns.T @ columns
    size = _averaged(prepared)
    width, derived = size * prepared.interval, prepared.derived_over > 0
    spread = white_noise(prepared, "position" if derived else "velocity")
    gram[0, 0] -= len(torque) * (6.0 * spread**2 / width**4 if derived else 2.0 * spread**2 / (size * width**2))
    if not gram[0, 0] > 0:
        return float("inf")
    return abs(float(np.linalg.lstsq(gram, columns.T @ torque, rcond=None)[0][0]))


@once
def _left(prepared: Recording) -> float:
    """Return the RMS torque that inertia, Coulomb and viscous friction and a constant leave of means of 40 ms."""
    torque, columns = _means(prepared)
    if len(torque) <= columns.shape[1]:
        return float("inf")
    scaled = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    left = torque - scaled @ np.linalg.lstsq(scaled, torque, rcond=None)[0]
    return float(np.sqrt(left @ left / (len(torque) - columns.shape[1])))


def _averaged(prepared: Recording) -> int:
    """Return over how many samples motion is averaged."""
    return max(2, round(_MEAN / prepared.interval))


def _means(prepared: Recording) -> tuple[Array, Array]:
    """Return means of the torque, shape (n,), and of acceleration, direction, speed and 1, shape (n, 4).

    From means of 20 ms: velocities are differentiated from one to the next, all else is the mean of both.
    """
    size, rows = _averaged(prepared), [np.zeros((5, 0))]
    for part in stretches(prepared.time, prepared.run):
        count = (part.stop - part.start) // size
        if count < 2:
            continue
        inside = slice(part.start, part.start + count * size)
        velocity, side, torque = (
            values[inside].reshape(count, size).mean(axis=1)
            for values in (prepared.velocity, np.sign(prepared.velocity), prepared.driving_torque)
        )
        both = [0.5 * (values[1:] + values[:-1]) for values in (torque, side, velocity)]
        rows.append(np.stack([np.diff(velocity) / (size * prepared.interval), *both, np.ones(count - 1)]))
    rate, torque, *friction = np.concatenate(rows, axis=1)
    return torque, np.column_stack([rate, *friction])
