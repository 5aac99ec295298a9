r"""Where the drive stands still, told from its motion by statistics.

The velocity is smoothed by local least squares. A sample may be at rest if the smoothed velocity is within three
standard errors, or one step of its sensor, of zero, and if the measured position does not drift. That happens at each
reversal too, so it must last: longer than a smooth passage through the band about zero, :math:`2 b/a`, with the band b
and the acceleration a with which this recording otherwise moves at low speed.

However exact its sensors are, a drive that creeps at less than :func:`standstill` rests: standing, it yields a little
to what pushes it, and where that ends only the last digits of a sample would say.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.in_place import BAND, bridged, held, in_place, pieces
from fricmodels.signals.lanczos import even_weights, lanczos_value
from fricmodels.signals.noise_colour import Noise, coloured_noise, may_be_there, most_noise
from fricmodels.signals.noise_level import best_half_width, best_smoothing, noise_of, quantum
from fricmodels.signals.segments import stretches
from fricmodels.signals.stamp_noise import with_false_stamps
from fricmodels.signals.unlike_files import with_own_noises

_LOOKS, _SAME = 4, 0.9
"""Rests are looked for so many times again, the noise being smaller by a tenth at least: in a band that is too wide
they begin before the drive has come to rest, and seem to show a larger noise."""
_ENOUGH = 100
"""Samples from which noise can be told."""
_WIDER = (2.0, 4.0, 8.0)
"""Bands about zero in which rests are sought again, in those of the noise that shows beside motion."""
_MORE, _AS_LARGE = 1.25, 0.5
"""Rests are more if they are longer by a quarter; noise in them is as large as supposed if it is half of that."""
_CLEARLY = 1.5
"""Ratio of standard deviations at which one noise is clearly more than another."""
_SHORT = 2.0
"""Noise that lasts so many samples is nearly white; it is not halved again."""
_LONG = 20.0
"""A rest, or all of them together, so many correlation times long tells how large the noise is."""

_STANDING = 0.01
"""Speed of a drive at standstill, in RMS changes of the velocity from sample to sample."""
_SLOW = 0.05
"""Share of the passages that are slower than the one taken as slow; it is the lower quartile of the acceleration over
time where the motion is Gaussian (Rice 1944)."""


@dataclass(frozen=True)
class _Motion:
    """What a recording shows of its motion.

    Attributes:
        noise: of the channel that it is taken from, the velocity or the position.
        velocity: smoothed, shape (N,). half_width: of the filter that smooths it. error: its standard error.
        resting: shape (N,).
    """

    noise: Noise
    half_width: int
    velocity: Array
    error: float
    resting: Mask


_MOTION_CHANNELS = ("time", "velocity", "position")
_known: dict[tuple[object, ...], tuple[list[weakref.ref[Any]], _Motion]] = {}


def _motion(recording: Recording) -> _Motion:
    """Return what a recording shows of its motion: found once for the same arrays, whatever else is recorded."""
    shown = _shown(recording)
    arrays: list[Any] = [recording[name] for name, _ in shown] + [recording.run]
    key = (*map(id, arrays), *shown)
    known = _known.get(key)
    if known is None or any(ref() is not array for ref, array in zip(known[0], arrays, strict=True)):
        found = _of_whole(recording) or _of_unlike_files(recording, _no_finer(recording, _found(recording)))
        known = _known[key] = ([weakref.ref(array, partial(_known.pop, key)) for array in arrays], found)
    return known[1]


def _shown(recording: Recording) -> tuple[tuple[str, bool], ...]:
    """Return the channels that tell the motion, and whether each was derived; the integral of a velocity tells none."""
    there = [name for name in _MOTION_CHANNELS if name in recording]
    return tuple((n, n in recording.derived) for n in there if n != "position" or recording.measures(n))


def _of_whole(recording: Recording) -> _Motion | None:
    """Return what the recording that another one was cut from shows, where it was cut; ``None`` if that is another.

    What was cut from a recording shows what that does.
    """
    if recording.origin is None:
        return None
    whole, index = recording.origin.whole, recording.origin.index
    shown = _shown(recording)
    if _shown(whole) != shown:
        return None
    if any(not np.array_equal(whole[name][index], recording[name]) for name, _ in shown if name != "time"):
        return None
    found = _motion(whole)
    return replace(found, noise=found.noise.at(index), velocity=found.velocity[index], resting=found.resting[index])


def _of_unlike_files(recording: Recording, found: _Motion) -> _Motion:
    return replace(found, noise=with_own_noises(recording, found.noise, lambda one: _found(one).noise))


def _no_finer(recording: Recording, found: _Motion) -> _Motion:
    """Return what a recording shows of its motion, with the rests in which it creeps below standstill.

    Only where its noise is known: as long as that is in doubt, a few rests would hide that there are others.
    """
    least = standstill(found.velocity) / BAND
    if found.error >= least:
        return found
    mask = _resting(recording, found.velocity, least)
    mask.setflags(write=False)
    return replace(found, error=least, resting=mask)


def _found(recording: Recording) -> _Motion:
    """Smooth the motion and find rests, again where the rests tell how large a lasting noise is.

    Beside motion it is only known how fast a lasting noise changes. What velocity and position differ by, and what is
    left at rest, has no motion in it.
    """
    by_position = _from_position(recording)
    values = recording["position"] if by_position else recording.velocity
    noise = noise_of(recording.time, values, recording.run)
    if by_position:
        return _seen(recording, with_false_stamps(recording, noise))
    noise = _not_less(noise, coloured_noise(_parts(recording), quiet=True))
    if recording.measures("position"):
        if noise.lasting:
            noise = noise.lasting_as(_square_beside_position(recording))
        noise = _not_less(noise, _beside_position(recording))
    if not noise.lasting:
        found = _seen(recording, noise)
        if not found.resting.any():
            found = _seen(recording, Noise(max(most_noise(_parts(recording)), noise.white)))
        noise = _not_less(noise, _at_rest(recording, found.resting))
        if not noise.lasting:
            noise = _in_wider_bands(recording, replace(found, noise=noise))
        if not noise.lasting:
            return found if noise is found.noise else _seen(recording, noise)
    found = _in_some_band(recording, noise)
    for _ in range(_LOOKS):
        if not found.resting.any():
            break
        better = noise.lasting_as(float(np.mean(values[found.resting] ** 2)))
        if np.count_nonzero(found.resting) < _LONG * better.samples:
            break
        settled = better.deviation > _SAME * found.noise.deviation
        found = found if settled else _seen(recording, better)
        if settled:
            break
    return found


def _in_some_band(recording: Recording, noise: Noise) -> _Motion:
    """Return what a recording shows of its motion with the largest lasting noise at which it is seen to stand still.

    Beside motion only an upper bound of that noise is known. In a band that is too wide no rest outlasts a passage
    through it. In one that is too narrow, rests fall into pieces, of which too few last.
    """
    first = found = _seen(recording, noise)
    while not found.resting.any() and noise.samples > _SHORT:
        noise = noise.lasting_as(noise.white**2 + 2.0 * noise.difference**2 + 0.5 * noise.lasting**2)
        found = _seen(recording, noise)
    return found if np.count_nonzero(found.resting) >= _LONG * noise.samples else first


def _not_less(noise: Noise, beside: Noise | None) -> Noise:
    """Return the noise that velocity and position differ by, where it is clearly more than what shows beside motion.

    Strokes of a few samples hide the noise of a velocity; and where it was computed from the same encoder, the position
    hides its noise.
    """
    return beside if beside is not None and beside.deviation > _CLEARLY * noise.deviation else noise


def _parts(recording: Recording) -> list[tuple[Array, Array]]:
    return [(recording.time[p], recording.velocity[p]) for p in stretches(recording.time, recording.run)]


def _at_rest(recording: Recording, resting: Mask) -> Noise | None:
    """Return the noise of the velocity at rest; ``None`` where there is too little of it."""
    parts = [(recording.time[a:b], recording.velocity[a:b]) for a, b in pieces(recording, resting)]
    return coloured_noise(parts, moving=False) if sum(len(time) for time, _ in parts) > _ENOUGH else None


def _in_wider_bands(recording: Recording, found: _Motion) -> Noise:
    """Return noise that does not last as it is, or lasting noise that changes as fast, if rests show that.

    Where noise lasts as long as the rests, its band seems narrow and rests fall into pieces. In a band twice as wide
    they are whole, and the noise in them is as large as was supposed. A drive that rests in white noise shows no more
    of it in a wider band. A slow passage does: so the noise must not have more than what happens from mean to mean.
    """
    noise, best = found.noise, found
    for factor in _WIDER:
        lasting = factor * noise.deviation
        # The fourth differences of a random walk are those of white noise if its steps have 3.5 times the variance.
        supposed = Noise(0.0, noise.difference, lasting, max(2.0 * factor**2 / 3.5, 1.0))
        if not may_be_there(supposed, _parts(recording)):
            break
        trial = _seen(recording, supposed)
        more = np.count_nonzero(trial.resting) > _MORE * np.count_nonzero(best.resting)
        if not more or float(np.mean(recording.velocity[trial.resting] ** 2)) < (_AS_LARGE * lasting) ** 2:
            break
        best = trial
    return best.noise


def _beside_position(recording: Recording) -> Noise | None:
    """Return the noise of the velocity by what it and the slope of the position differ by: no motion is in that.

    Velocity behind position makes a difference, too: what goes with the acceleration is taken out. ``None`` where the
    noise of the position is a quarter of it or more.
    """
    parts: list[tuple[Array, Array]] = []
    accelerations: list[Array] = []
    for part in stretches(recording.time, recording.run):
        if part.stop - part.start < 8:
            continue
        time, velocity, position = recording.time[part], recording.velocity[part], recording["position"][part]
        steps = time[2:] - time[:-2]
        parts.append((time[1:-1], velocity[1:-1] - (position[2:] - position[:-2]) / steps))
        accelerations.append((velocity[2:] - velocity[:-2]) / steps)
    if not parts:
        return None
    acceleration, apart = np.concatenate(accelerations), np.concatenate([values for _, values in parts])
    square = float(acceleration @ acceleration)
    behind = float(acceleration @ apart) / square if square > 0.0 else 0.0
    found = coloured_noise(
        [(time, values - behind * own) for (time, values), own in zip(parts, accelerations, strict=True)], moving=False
    )
    of_position = noise_of(recording.time, recording["position"], recording.run).deviation
    of_position = max(of_position, quantum(recording["position"]) / np.sqrt(12.0)) / recording.interval
    return found if found.deviation**2 > 4.0 * 0.5 * of_position**2 else None


def _square_beside_position(recording: Recording) -> float:
    """Return the mean square of the velocity's noise by what mean velocities and changes of position differ by."""
    parts = []
    for part in stretches(recording.time, recording.run):
        if part.stop - part.start < 3:
            continue
        time, velocity = recording.time[part], recording.velocity[part]
        means = 0.5 * (velocity[1:] + velocity[:-1]) - np.diff(recording["position"][part]) / np.diff(time)
        parts.append((0.5 * (time[1:] + time[:-1]), means))
    found = coloured_noise(parts, moving=False)
    return found.white**2 + found.lasting**2


def _seen(recording: Recording, noise: Noise) -> _Motion:
    time, run, slow = recording.time, recording.run, noise.slow
    order = int(_from_position(recording))
    values = recording["position"] if order else recording.velocity
    if slow.lasting and not order:
        width = best_smoothing(time, values, slow, run)
    else:
        width = best_half_width(time, values, run, noise=slow)
    smooth = lanczos_value(time, values, width, run, order=order)
    error = slow.after(even_weights(width)[order]) / (recording.interval if order else 1.0)
    rounding = 8.0 * np.spacing(np.abs(values).max()) / (recording.interval if order else 1.0)
    error = max(error, float(rounding))
    mask = _resting(recording, smooth, error)
    smooth.setflags(write=False)
    mask.setflags(write=False)
    return _Motion(noise, width, smooth, error, mask)


def resting(recording: Recording) -> Mask:
    """Return where the drive stands still, shape (N,).

    From the measured velocity; from the position where the velocity is not there or was derived. Without a position
    the torque tells that it did not move between two rests.

    Raises:
        InputError: when the recording has neither.
    """
    found = _motion(recording)
    measured = recording.measures("position")
    return found.resting if measured or "torque" not in recording.channels else _held(recording)


@once
def _held(recording: Recording) -> Mask:
    found = _motion(recording)
    if recording.origin is not None and _of_whole(recording) is not None:
        return np.asarray(resting(recording.origin.whole)[recording.origin.index])
    return held(recording, found.resting, found.velocity, BAND * BAND * found.error)


def motion_noise(recording: Recording) -> Noise:
    """Return the noise of the channel that tells the motion: of the velocity, or of the position it is derived from."""
    return _motion(recording).noise


def velocity_noise(recording: Recording) -> Noise:
    """Return the noise of the velocity that stands in a recording, measured or derived."""
    if recording.derived_over:
        weights = even_weights(recording.derived_over)[1][::-1] / recording.interval
        noise = motion_noise(recording)
        return replace(noise, filtered=weights, at_rest=noise.at_rest and replace(noise.at_rest, filtered=weights))
    if _from_position(recording):
        return noise_of(recording.time, recording.velocity, recording.run)
    return motion_noise(recording)


def smoothing_half_width(recording: Recording) -> int:
    """Return the half width of the filter that smooths the velocity that stands in a recording."""
    if _from_position(recording):
        return best_half_width(recording.time, recording.velocity, recording.run)
    return _motion(recording).half_width


def smoothed_velocity(recording: Recording) -> tuple[Array, float]:
    """Return the velocity, smoothed, and its standard error from noise and quantisation."""
    found = _motion(recording)
    return found.velocity, found.error


def _resting(recording: Recording, velocity: Array, error: float) -> Mask:
    band = BAND * error
    if not _from_position(recording):
        band = max(band, 1.01 * _step_of_velocity(recording))
    still = np.abs(velocity) <= band
    lasting = passage(recording, velocity, band)
    if recording.measures("position"):
        still &= in_place(recording, still, band, lasting, standstill(velocity))
    mask = np.zeros(len(recording), dtype=bool)
    for start, stop in pieces(recording, still):
        mask[start:stop] = recording.time[stop - 1] - recording.time[start] > lasting
    return bridged(recording, mask) if recording.measures("position") else mask


@once
def _step_of_velocity(recording: Recording) -> float:
    return quantum(recording.velocity)


def _from_position(recording: Recording) -> bool:
    return "velocity" not in recording or ("velocity" in recording.derived and "position" in recording)


def standstill(velocity: Array) -> float:
    """Return the speed below which a velocity is zero: its sign would be that of the last digits of a sample.

    It is a hundredth of the RMS change from sample to sample, so that a drive that turns hardly ever stops there.
    """
    change = np.diff(velocity)
    return _STANDING * float(np.sqrt(np.mean(np.square(change, out=change)))) if len(change) else 0.0


def passage(recording: Recording, velocity: Array, band: float) -> float:
    """Return how long [s] a passage through the band about zero lasts, going at the slower of the usual accelerations.

    The usual acceleration is taken where the speed is low but certain. Each sample counts by the change of speed that
    it stands for, so that motion at a constant low speed, which passes nothing, does not count.
    """
    speed = np.abs(velocity)
    moving = speed > band
    if not moving.any():
        return 0.0
    low = moving & (speed <= max(np.quantile(speed[moving], 0.25), 2.0 * band))
    slope = lanczos_value(recording.time, velocity, 5, recording.run, order=1)
    acceleration = np.sort(np.abs(slope)[low])
    passed = np.cumsum(acceleration)
    slow = float(acceleration[np.searchsorted(passed, _SLOW * passed[-1])])
    shortest = 3.0 * recording.interval
    return max(2.0 * band / slow, shortest) if slow > 0.0 else shortest
