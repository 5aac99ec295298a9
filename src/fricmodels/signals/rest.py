r"""Where the drive stands still, told from its motion by statistics.

The velocity is smoothed by local least squares. A sample may be at rest if the smoothed velocity is within three
standard errors, or one step of its sensor, of zero, and if the measured position does not drift. That happens at each
reversal too, so it must last: longer than a smooth passage through the band about zero, :math:`2 b/a`, with the band b
and the acceleration a with which this recording otherwise moves at low speed.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterator
from functools import wraps
from typing import TypeVar

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import Recording
from fricmodels.signals.lanczos import even_weights, lanczos_derivative
from fricmodels.signals.noise_level import best_half_width, noise, quantum
from fricmodels.signals.segments import stretches

_BAND = 3.0
"""Standard errors from zero within which a velocity is no evidence of motion."""

Found = TypeVar("Found")

_STANDING = 0.01
"""Speed of a drive at standstill, in RMS changes of the velocity from sample to sample."""
_SLOW = 0.05
"""Share of the passages that are slower than the one taken as slow; it is the lower quartile of the acceleration over
time where the motion is Gaussian (Rice 1944)."""


def once(find: Callable[[Recording], Found]) -> Callable[[Recording], Found]:
    """Let a function find what it does once for each recording; its arrays are not to be written to."""
    known: dict[int, tuple[weakref.ref[Recording], Found]] = {}

    @wraps(find)
    def found(recording: Recording) -> Found:
        key = id(recording)
        if key not in known or known[key][0]() is not recording:
            known[key] = (weakref.ref(recording, lambda _: known.pop(key, None)), find(recording))
        return known[key][1]

    return found


@once
def resting(recording: Recording) -> Mask:
    """Return where the drive stands still, shape (N,).

    From the measured velocity; from the position where the velocity is not there or was derived.

    Raises:
        InputError: when the recording has neither.
    """
    velocity, error = smoothed_velocity(recording)
    band = _BAND * error
    if not _from_position(recording):
        band = max(band, 1.01 * quantum(recording.velocity))
    still = np.abs(velocity) <= band
    passage = _passage(recording, velocity, band)
    if "position" in recording and "position" not in recording.derived:
        still &= _in_place(recording, still, band, passage)
    mask = np.zeros(len(recording), dtype=bool)
    for start, stop in _borders(recording, still):
        mask[start:stop] = recording.time[stop - 1] - recording.time[start] > passage
    mask.setflags(write=False)
    return mask


def _from_position(recording: Recording) -> bool:
    return "velocity" not in recording or ("velocity" in recording.derived and "position" in recording)


def _in_place(recording: Recording, still: Mask, band: float, passage: float) -> Mask:
    """Tell where the position changes no more than its sensor does at rest, while the velocity may be zero.

    Over as long as a drive that creeps at the limit of the band needs to show it; over the whole of shorter stretches.
    """
    position = recording["position"]
    spread = _BAND * np.sqrt(2.0) * noise(recording.time, position, recording.run)
    allowed = max(spread, 1.01 * quantum(position))
    count = max(1, round(max(passage, 2.0 * allowed / band) / recording.interval))
    result = np.zeros(len(position), dtype=bool)
    for start, stop in _borders(recording, still):
        at = np.arange(start, stop)
        first = np.clip(at - count // 2, start, max(start, stop - 1 - count))
        last = np.minimum(first + count, stop - 1)
        result[start:stop] = np.abs(position[last] - position[first]) <= allowed
    return result


def _borders(recording: Recording, mask: Mask) -> Iterator[tuple[int, int]]:
    """Yield start and stop of each piece of an uninterrupted stretch where the mask holds."""
    for part in stretches(recording.time, recording.run):
        edges = np.flatnonzero(np.diff(np.r_[0, mask[part].astype(np.int8), 0])) + part.start
        yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


@once
def smoothed_velocity(recording: Recording) -> tuple[Array, float]:
    """Return the velocity, smoothed, and its standard error from noise and quantisation."""
    time, run = recording.time, recording.run
    order = int(_from_position(recording))
    values = recording["position"] if order else recording.velocity
    width = best_half_width(time, values, run)
    smooth = lanczos_derivative(time, values, width, run)[order]
    gain = float(np.linalg.norm(even_weights(width)[order]))
    error = noise(time, values, run) * gain / (recording.interval if order else 1.0)
    rounding = 8.0 * np.spacing(np.abs(values).max()) / (recording.interval if order else 1.0)
    smooth.setflags(write=False)
    return smooth, max(error, float(rounding))


def standstill(velocity: Array) -> float:
    """Return the speed below which a velocity is zero: its sign would be that of the last digits of a sample.

    It is a hundredth of the RMS change from sample to sample, so that a drive that turns hardly ever stops there.
    """
    return _STANDING * float(np.sqrt(np.mean(np.diff(velocity) ** 2))) if len(velocity) > 1 else 0.0


def _passage(recording: Recording, velocity: Array, band: float) -> float:
    """Return how long [s] a passage through the band about zero lasts, going at the slower of the usual accelerations.

    The usual acceleration is taken where the speed is low but certain. Each sample counts by the change of speed that
    it stands for, so that motion at a constant low speed, which passes nothing, does not count.
    """
    speed = np.abs(velocity)
    moving = speed > band
    if not moving.any():
        return 0.0
    low = moving & (speed <= max(np.quantile(speed[moving], 0.25), 2.0 * band))
    acceleration = np.sort(np.abs(_slope(recording, velocity))[low])
    passed = np.cumsum(acceleration)
    slow = float(acceleration[np.searchsorted(passed, _SLOW * passed[-1])])
    shortest = 3.0 * recording.interval
    return max(2.0 * band / slow, shortest) if slow > 0.0 else shortest


def _slope(recording: Recording, velocity: Array) -> Array:
    return lanczos_derivative(recording.time, velocity, 5, recording.run)[1]
