"""A recording as every fit and every score takes it: with a velocity, an acceleration, and time from its start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals import best_half_width, noise_of, prepare, velocity_noise, with_derived_velocity
from fricmodels.signals.lanczos import even_weights


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
    """Return a recording with velocity and acceleration, and with time from its start.

    Raises:
        InputError: when the recording does not move.
    """
    prepared = prepare(surest_velocity(recording))
    if float(np.ptp(prepared.velocity)) == 0:
        raise InputError(f"recording '{recording.name}' does not move; record some motion")
    return prepared.with_channels(derived="time" in recording.derived, time=prepared.time - prepared.time[0])


def surest_velocity(recording: Recording) -> Recording:
    """Return the recording with the velocity derived from the position, where that is the more certain of the two.

    An encoder's position often gives a better velocity than the noisy channel beside it. The two must agree: the
    measured velocity is the derived one, to within a hundredth in scale and its own noise.
    """
    if "velocity" not in recording or "position" not in recording or "velocity" in recording.derived:
        return recording
    time, run, position, velocity = recording.time, recording.run, recording["position"], recording.velocity
    counted = noise_of(time, position, run)
    width = best_half_width(time, position, run, noise=counted)
    result = with_derived_velocity(recording, width)
    derived = result.velocity
    error = counted.after(even_weights(width)[1]) / recording.interval
    own = velocity_noise(recording).deviation
    power = float(derived @ derived)
    if error >= own or power == 0:
        return recording
    scale = float(derived @ velocity) / power
    left = float(np.sqrt(np.mean((velocity - scale * derived) ** 2)))
    if abs(scale - 1) > 0.01 or left > 1.5 * float(np.hypot(own, error)):
        return recording
    return result
