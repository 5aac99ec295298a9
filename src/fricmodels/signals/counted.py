r"""Velocities that are differences of counts, of which the position itself was not recorded.

A counter that is read once a sample gives a velocity in steps of one count to a sample, q/Δt. At half a count a sample
it is 0 and 1 in turn, far from any smooth speed; but its sum is the position, and never off by more than a count. Of a
velocity that was rounded, with noise in it, the errors add up instead: of a variance σ² in steps, L of them to a
variance of L σ². So the two are told apart.
"""

from __future__ import annotations

import numpy as np

from fricmodels.arrays import Array
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.signals.lanczos import lanczos_value
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.segments import stretches

_LEAST, _MOST = 500, 100_000
"""Samples of the longest stretch from which that is told; of a longer one so many in its middle."""
_WIDTHS = (16, 32, 64, 128)
"""Samples of a passage: too short for the motion to be other than smooth, or long enough for errors to add up."""
_WOULD_ADD_UP = 4.0
"""Squared counts to which independent errors would add up over a passage that tells."""
_OFF, _SHARE = 0.8, 0.83
"""Of sums of counts 96 % are off by less than 0.8 (the difference of two roundings), of independent errors 68 % at most
(a standard deviation of 2, of which smoothing leaves 0.4): the border lies about half-way."""
_PASSAGES = 20
"""Passages that tell, side by side, from which that is known."""
_ON_GRID = 0.05


def with_counted_position(recording: Recording) -> Recording:
    """Return the recording with the sum of its velocity as position, where that is a difference of counts.

    The position begins at zero in each stretch. Recordings that have one, and other velocities, are left as they are.
    """
    step = step_of_counts(recording)
    if not step:
        return recording
    parts = stretches(recording.time, recording.run)
    sums = [sum_of_counts(recording.velocity[part], step, recording.interval) for part in parts]
    return recording.with_channels(derived=False, position=np.concatenate(sums))


def sum_of_counts(velocity: Array, step: float, interval: float) -> Array:
    """Return the position at the samples of a stretch, from the one before it on, shape (N,)."""
    return np.asarray(np.cumsum(np.round(velocity / step)) * step * interval)


@once
def step_of_counts(recording: Recording) -> float:
    """Return the velocity of one count a sample, where a difference of counts is all that tells the motion; else 0."""
    if "position" in recording or not recording.measures("velocity"):
        return 0.0
    longest = max(stretches(recording.time, recording.run), key=lambda part: part.stop - part.start)
    step = quantum(recording.velocity) if longest.stop - longest.start >= _LEAST else 0.0
    return step if step and _adds_up(recording.time[longest], recording.velocity[longest] / step) else 0.0


def _adds_up(time: Array, steps: Array) -> bool:
    """Whether what a velocity, in steps, differs from a smooth one by adds up to no more than counts are off by."""
    middle = slice(max(0, (len(steps) - _MOST) // 2), (len(steps) + _MOST) // 2)
    time, steps = time[middle], steps[middle]
    counts = np.round(steps)
    if np.mean(np.abs(steps - counts) < _ON_GRID) < 1.0 - _ON_GRID:
        return False
    for width in _WIDTHS:
        error = counts - lanczos_value(time, counts, width)
        total, square = (np.concatenate([[0.0], np.cumsum(values)]) for values in (error, error**2))
        telling = square[width:] - square[:-width] >= _WOULD_ADD_UP
        sums = np.abs(total[width:] - total[:-width])[telling]
        if len(sums) >= _PASSAGES * width and np.mean(sums < _OFF) > _SHARE:
            return True
    return False
