"""A recording as every fit and every score takes it: with a velocity, an acceleration, and time from its start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import rms
from fricmodels.errors import InputError
from fricmodels.once import once
from fricmodels.processes import give_back
from fricmodels.recording import Recording
from fricmodels.score.bands import WINDOWS
from fricmodels.signals import best_half_width, noise_of, prepare, velocity_noise, with_derived_velocity
from fricmodels.signals.beginnings import with_true_beginnings
from fricmodels.signals.counted import with_counted_position
from fricmodels.signals.differences import is_difference
from fricmodels.signals.integrated import with_integral_marked, with_integrated_position
from fricmodels.signals.lanczos import even_weights
from fricmodels.signals.noise_colour import Noise
from fricmodels.signals.stamp_noise import with_false_stamps
from fricmodels.signals.stamps import with_even_stamps
from fricmodels.weakform.smoothed import MAX_SAMPLES

_TYPICAL = 40
"""Samples that a test function of usual width spans."""
_CLEARLY = 2.0
"""Times the noise; a convention."""


def prepared(recording: Recording) -> Recording:
    """Return a recording that is ready, whether it is whole or cut from another one.

    What is derived is derived from the whole, so that nothing changes at a cut.

    Raises:
        InputError: when the recording does not move.
    """
    if recording.origin is None:
        return recording if "acceleration" in recording.derived else ready(recording)
    if "acceleration" in recording.derived:
        return recording
    whole = ready(recording.origin.whole)
    part = whole.remembering().select(recording.origin.index, recording.name)
    return replace(part, run=recording.run)


def ready(recording: Recording) -> Recording:
    """Return a recording with velocity, position and acceleration, and with time from its start.

    The same one every time, so that all fits to it know its noise and rests; a long one is not kept.

    Raises:
        InputError: when the recording does not move.
    """
    return _kept(recording) if len(recording) <= MAX_SAMPLES else _ready(recording)


def _ready(recording: Recording) -> Recording:
    begun = with_integral_marked(with_counted_position(with_true_beginnings(recording)))
    known_by_position = _both_measured(begun) and is_difference(begun)  # as told by the stamps that it was made with
    prepared = prepare(surest_velocity(with_even_stamps(begun), known_by_position=known_by_position))
    if float(np.ptp(prepared.velocity)) == 0:
        raise InputError(f"recording '{recording.name}' does not move; record some motion")
    give_back(len(prepared))
    time, begin = prepared.time, float(prepared.time[0])
    begun = prepared.with_channels(derived="time" in recording.derived, time=time - begin if begin else time)
    return with_integrated_position(begun)


_kept = once(_ready)


def _both_measured(recording: Recording) -> bool:
    return recording.measures("velocity") and recording.measures("position")


def surest_velocity(recording: Recording, *, known_by_position: bool = False) -> Recording:
    """Return the recording with the velocity derived from the position, where that is the more certain of the two.

    An encoder's position often gives a better velocity than the noisy channel beside it: once smoothed it has less
    noise, and so have accelerations from it (:func:`_is_quieter`; the measured one is smoothed there, too). The two
    must agree: the measured velocity is the derived one, to within a hundredth in scale and its own noise. Where it
    was itself computed as a difference of the positions it says nothing more than they do, and says that smeared or
    late. Where it comes later than the positions, filtered by its drive or held up on a bus, all that it is off by is
    its error. Where it certainly has another scale than they have, as by a calibration, it is divided by the ratio
    first.

    Args:
        recording: as measured.
        known_by_position: whether the velocity is such a difference.
    """
    if not _both_measured(recording):
        return recording
    from fricmodels.logcheck.rates import is_late  # costs a tenth of a second, and few recordings come here
    from fricmodels.logcheck.scale import other_scale

    times = 1.0 if known_by_position else other_scale(recording)
    if times != 1.0:
        recording = recording.with_channels(derived=False, velocity=recording.velocity / times)
    time, run, position, velocity = recording.time, recording.run, recording["position"], recording.velocity
    counted = with_false_stamps(recording, noise_of(time, position, run))
    width = best_half_width(time, position, run, noise=counted.slow)
    result = with_derived_velocity(recording, width)
    if known_by_position:
        return result
    derived = result.velocity
    error = counted.after(even_weights(width)[1]) / recording.interval
    own = velocity_noise(recording)
    power = float(derived @ derived)
    apart = rms(velocity - derived)
    if error < apart / np.sqrt(2.0) and is_late(recording):
        return result
    if error >= own.deviation or power == 0 or not _is_quieter(counted, own, recording.interval):
        return recording
    scale = float(derived @ velocity) / power
    left = rms(velocity - scale * derived)
    if abs(scale - 1) > 0.01 or left > 1.5 * float(np.hypot(own.deviation, error)):
        return recording
    return result


def _is_quieter(position: Noise, velocity: Noise, interval: float) -> bool:
    r"""Whether an acceleration from positions has less noise than one from velocities, or not clearly more.

    They are the longest window over which errors are printed, and a test function, as rows are. Their weights φ are on
    the changes of the velocity, which is Δφ on velocities and Δ²φ/h on positions: what a position is off by is divided
    by h, but nearly all of it comes back with the other sign. So positions are the better the wider the scale is, and
    neither scale decides alone: what counts is the geometric mean of the two ratios. Where it is about one positions
    stay, whose rows are wider.

    Args:
        position, velocity: noise of the two, with its colour.
        interval: h between samples [s].
    """
    ratio = 1.0
    reach = max(1, round(max(WINDOWS) / interval))
    triangle = 1.0 - np.abs(np.arange(1 - reach, reach)) / reach
    test_function = (1.0 - np.linspace(-1.0, 1.0, _TYPICAL + 1)[1:-1] ** 2) ** 2
    for changes in (triangle, test_function):
        on_velocities = np.diff(changes, prepend=0.0, append=0.0)
        on_positions = np.diff(on_velocities, prepend=0.0, append=0.0) / interval
        own = velocity.after(on_velocities)
        ratio *= position.after(on_positions) / own if own > 0.0 else np.inf
    return ratio < _CLEARLY**2
