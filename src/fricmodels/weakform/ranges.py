"""The recording's own sizes of quantities, in which the values of a parameter that are tried first are counted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmodels.arrays import rms
from fricmodels.dimension import ACCELERATION, DISPLACEMENT, TIME, VELOCITY, Dimension
from fricmodels.once import once
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.signals.lanczos import lanczos_value
from fricmodels.signals.rest import resting, smoothed_velocity
from fricmodels.signals.unseen_way import SHORTEST, turning, unseen_way

_WIDTH = 2
"""Samples to either side of one from which its acceleration is told."""
_STROKE = 0.01
"""Share of the longest stroke that another one goes at least. On four joints of a KR300 noise makes pieces of up to
0.0001 of it; without this bound one of them had a jump after the first such piece. Strokes of a thousandth, which are
there too, tell little of a friction."""
_FOLLOWS = 1.5**0.5
"""Least ratio r of a part's natural frequency to that of the slow motion. Undamped, the part swings r²/(r² − 1) times
as far as the drive: three times. At r = 1 it would do whatever one sine asks for."""
_SLOW = 0.1
"""Share of its motion in which a drive is so slow that a part follows it: a sweep may pass the resonance after that."""
_RECORD = 20_000
"""Samples of a record in which a time of the drive's own is counted."""


def natural_size(recording: Recording, dimension: Dimension) -> float:
    """Return the recording's own size of a quantity: peak velocity, position range, duration, RMS torque.

    Where a displacement is involved time is counted in that of crossing the range at peak velocity, else in durations.
    """
    peak, duration, force, length = _sizes(recording)
    size = force ** float(dimension.force)
    along, time = float(dimension.displacement), float(dimension.time)
    if along == 0:
        return float(size * duration**time)
    return float(size * peak**-time * length ** (along + time))


@once
def _sizes(recording: Recording) -> tuple[float, float, float, float]:
    """Return peak velocity, duration, RMS torque and position range."""
    peak = float(np.max(np.abs(recording.velocity)))
    duration = float(np.ptp(recording.time))
    force = recording.rms_torque
    length = float(np.ptp(recording["position"])) if "position" in recording else peak * duration
    return peak, duration, force, length


def scan_size(recording: Recording, parameter: Parameter) -> float:
    """Return the recording's own size of a parameter, in which its ``scan`` is counted.

    A time of the drive's own does not grow with how long was recorded: it is counted in 20 000 samples at most. An
    acceleration is counted in that of the motion, which does not fall with how far the drive goes.
    """
    if parameter.dimension == ACCELERATION:
        return _acceleration(recording)
    size = natural_size(recording, parameter.dimension)
    if not parameter.own_time:
        return size
    records = _sizes(recording)[1] / (_RECORD * recording.interval)
    return float(size * max(records, 1.0) ** -float(parameter.dimension.time))


@once
def _acceleration(recording: Recording) -> float:
    """Return the RMS acceleration of a motion, or of an even one that which its natural sizes make."""
    velocity, _ = smoothed_velocity(recording)
    rate = lanczos_value(recording.time, velocity, _WIDTH, recording.run, order=1)
    return rms(rate) or natural_size(recording, ACCELERATION)


def scan_values(recording: Recording, parameter: Parameter) -> list[float]:
    """Return the values of a parameter that are tried first: a place within the travel, an instant within time."""
    origin = float(np.min(recording.time)) if parameter.instant else 0.0
    if parameter.place and "position" in recording:
        origin = float(np.min(recording["position"]))
    return [origin + value * scan_size(recording, parameter) for value in parameter.scan]


def within_motion(recording: Recording, parameter: Parameter) -> Parameter:
    """Return a parameter with the bounds that the motion sets; most have none.

    A place lies within the travel. A duration is no less than two samples: a shorter one says when samples were taken.
    So is a speed below which friction differs: the drive is slower than it for no less than that, as it turns. (One
    that may be negative is a part of such a speed.) And so is a length over which a contact bends or a gap is crossed:
    from standstill the drive goes that far in no less than that, and in no less than two counts of a position from
    which the velocity was derived: where it turned is known to one count on either side. A part on a spring follows the
    drive where that is slow: there it swings, undamped, at most three times as far, so that its natural frequency is at
    least √1.5 times that of the slow motion. Nor does it swing from side to side in less than two samples: faster, what
    it does is when samples were taken.
    """
    lower, upper = parameter.lower, parameter.upper
    if parameter.dimension == TIME and not (parameter.instant or parameter.delay):
        lower = min(max(lower, SHORTEST * recording.interval), upper)
    elif parameter.dimension == VELOCITY and lower >= 0.0:
        lower = min(max(lower, 0.5 * SHORTEST * recording.interval * turning(recording)), upper)
    elif parameter.dimension == DISPLACEMENT and not (parameter.place or parameter.periodic):
        lower = min(max(lower, unseen_way(recording)), upper)
    elif parameter.resonance:
        upper = min(upper, np.pi / (SHORTEST * recording.interval))
        lower = max(lower, _FOLLOWS * slow_angular_frequency(recording))
    elif parameter.place and "position" in recording:
        position = recording["position"]
        lower, upper = max(lower, float(position.min())), min(upper, float(position.max()))
    if lower > upper or (lower, upper) == (parameter.lower, parameter.upper):
        return parameter
    return replace(parameter, lower=lower, upper=upper, initial=min(max(parameter.initial, lower), upper))


@once
def slow_angular_frequency(recording: Recording) -> float:
    """Return the angular frequency below which the drive goes back and forth for a tenth of its motion [rad/s].

    That is π over the duration of a stroke from reversal to reversal, without rests; a sweep has short ones and long
    ones. A stroke that is cut, where a part of the record is kept back, is as long as it was. 0 where the drive never
    turns.
    """
    recording = recording if recording.origin is None else recording.whole()
    velocity, error = smoothed_velocity(recording)
    clear = np.flatnonzero(np.abs(velocity) > 3.0 * error)
    forward, run = velocity[clear] > 0.0, recording.run[clear]
    if not np.any(forward[1:] != forward[:-1]):
        return 0.0
    begins = np.flatnonzero((forward[1:] != forward[:-1]) | (run[1:] != run[:-1])) + 1
    moved = np.concatenate([[0], np.cumsum(~resting(recording))])
    longest = np.sort(np.diff(moved[np.concatenate([clear[:1], clear[begins], clear[-1:] + 1])]))[::-1]
    slow = longest[np.searchsorted(np.cumsum(longest), _SLOW * longest.sum())]
    return float(np.pi / (slow * recording.interval))


def between_strokes(recording: Recording) -> tuple[float, float]:
    """Return the instants [s] between which a jump has a whole stroke of one direction on either side.

    What jumps within the first stroke of a direction, or within the last, cannot be told from an offset and a single
    stroke. Where each direction has but one stroke, no jump can be told, and the first instant is after the last; with
    one direction these are the record's ends. Noise breaks a slow motion into pieces: what goes less far than a
    hundredth of the longest stroke is none.
    """
    strokes, ends = _strokes(recording), (float(np.min(recording.time)), float(np.max(recording.time)))
    found = [(side[0][1], side[-1][0]) for side in strokes if len(side) > 1]
    if found:
        return min(first for first, _ in found), max(last for _, last in found)
    return ends[::-1] if all(strokes) else ends


def _strokes(recording: Recording) -> list[list[tuple[float, float]]]:
    """Return when the strokes of each direction begin and end [s], forward and backward."""
    velocity, error = smoothed_velocity(recording)
    time, moving = recording.time, np.abs(velocity) > 3.0 * error
    travelled = np.concatenate([[0.0], np.cumsum(np.abs(velocity[1:]) * np.diff(time))])
    pieces = []
    for side in (1.0, -1.0):
        on = moving & (side * velocity > 0.0)
        joined = on[1:] & on[:-1] & (np.diff(recording.run) == 0)
        pieces.append([np.flatnonzero(on & ~beside) for beside in (np.r_[False, joined], np.r_[joined, False])])
    least = _STROKE * max(float(np.max(travelled[end] - travelled[begin], initial=0.0)) for begin, end in pieces)
    return [
        [(float(time[i]), float(time[j])) for i, j in zip(*piece, strict=True) if travelled[j] - travelled[i] >= least]
        for piece in pieces
    ]
