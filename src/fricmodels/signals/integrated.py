r"""The position of a recording that has none: the integral of its velocity.

.. math:: q(t) = \int_0^t \omega\,dt

from zero at the first sample of each run, by the trapezium rule. What it lacks is where each run began, and it wanders
with the errors of the velocity: by :math:`\sigma \sqrt{t\,\Delta t}` after a time t if they are white, of standard
deviation σ. A torque over the position shows in it all the same, as long as that is short against its waves.

A position that was recorded may be just that as well: computed from the velocity by whoever made the file. Then it has
the noise of the velocity in it, added up, and as a sensor of its own it would seem to be nearly without noise.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.recording import Recording

_FAR, _OF_STEP, _OF_WALK, _EXCEPTIONS = 64, 1.0, 0.5, 0.01
"""Samples after which noise that was added up shows beside rounding; by how much a position may be off the integral
after one and after so many, in standard deviations of what the velocity's noise would make of a position of its own;
and the share of the samples that may be off more. (Of an independent sensor 16 and 62 % are.)"""
_LEAST, _MOST = 4 * _FAR, 100_000
"""Samples from which that is told; of a longer record so many in its middle."""
_NOISE = 1e-5
"""Share of the RMS velocity below which its noise is that of a computation: added up it harms nothing."""


def with_integral_marked(recording: Recording) -> Recording:
    """Return a recording in which a position that is the integral of the velocity beside it is marked as derived."""
    if not (recording.measures("position") and recording.measures("velocity") and is_integral(recording)):
        return recording
    return recording.with_channels(position=recording["position"])


def is_integral(recording: Recording) -> bool:
    r"""Whether the position is the integral of the velocity, by the trapezium rule, to within its rounding.

    A sensor of its own does not know the noise of the velocity's. The position would be off the integral by
    :math:`\sigma\,\Delta t / \sqrt 2` at least from sample to sample, and by :math:`\sigma\,\Delta t \sqrt m` after m
    samples. Nor is it one that the velocity was derived from: of a difference, backward or central, the integral lacks
    half of the fast noise of the position.
    """
    from fricmodels.signals.rest import velocity_noise

    some = slice(max(0, (len(recording) - _MOST) // 2), (len(recording) + _MOST) // 2)
    time, position, velocity = recording.time[some], recording["position"][some], recording.velocity[some]
    run = recording.run[some]
    if np.count_nonzero(run[_FAR:] == run[:-_FAR]) < _LEAST:
        return False
    noise = velocity_noise(recording).deviation
    if not noise > _NOISE * rms(velocity):
        return False
    off, step = position - way(time, velocity), noise * recording.interval
    for samples, allowed in ((1, _OF_STEP * step), (_FAR, _OF_WALK * step * np.sqrt(_FAR))):
        within = run[samples:] == run[:-samples]
        apart = np.abs(off[samples:] - off[:-samples])[within]
        if float(np.mean(apart > allowed)) > _EXCEPTIONS:
            return False
    return True


def with_integrated_position(recording: Recording) -> Recording:
    """Return a recording with a position, marked as derived, where only its velocity was measured; else as it is."""
    if "position" in recording or not recording.measures("velocity"):
        return recording
    return recording.with_channels(position=from_zero(recording, recording.velocity))


def from_zero(recording: Recording, velocity: Array) -> Array:
    """Return the integral of a velocity along a recording, from zero at the first sample of each run, shape (N,)."""
    position = way(recording.time, velocity)
    for number in recording.run_numbers:
        inside = recording.run == number
        position[inside] -= position[np.argmax(inside)]
    return position


def way(time: Array, velocity: Array) -> Array:
    """Return the integral of a velocity from the first sample on, shape (N,)."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
