"""Where the position, or the torque, says that a drive stays in its place, whatever the velocity shows."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import Recording
from fricmodels.signals.noise_level import noise_of, quantum
from fricmodels.signals.segments import stretches

BAND = 3.0
"""Standard errors from zero within which a velocity, or a change of position, is no evidence of motion."""


def in_place(recording: Recording, still: Mask, band: float, passage: float, standing: float) -> Mask:
    """Tell where the position changes no more than its sensor does at rest, while the velocity may be zero.

    Over as long as a drive that creeps at the limit of the band needs to show it; over the whole of shorter stretches.

    Args:
        recording: with a measured position.
        still: where the velocity may be zero, shape (N,).
        band: velocity up to which it may.
        passage: how long a drive takes to pass through the band [s].
        standing: speed below which a drive does not move, however well its sensor shows that it creeps.
    """
    position, time, allowed = recording["position"], recording.time, _within_sensor(recording)
    count = max(1, round(max(passage, 2.0 * allowed / band) / recording.interval))
    result = np.zeros(len(position), dtype=bool)
    for start, stop in pieces(recording, still):
        at = np.arange(start, stop)
        first = np.clip(at - count // 2, start, max(start, stop - 1 - count))
        last = np.minimum(first + count, stop - 1)
        apart, most = position[last] - position[first], np.maximum(allowed, standing * (time[last] - time[first]))
        result[start:stop] = np.abs(apart) <= most
    return result


def bridged(recording: Recording, mask: Mask) -> Mask:
    """Join rests between which the position does not change: the velocity that shows there is its sensor's.

    A drive that had left its place between two rests would have had to come back to it, within one step of the sensor.
    """
    position, allowed, joined = recording["position"], _within_sensor(recording), mask.copy()
    for (start, end), (begin, _) in pairwise(pieces(recording, mask)):
        if recording.run[start] == recording.run[begin] and np.ptp(position[end - 1 : begin + 1]) <= allowed:
            joined[end:begin] = True
    return joined


def held(recording: Recording, mask: Mask, velocity: Array, slow: float) -> Mask:
    """Join rests between which the velocity is small and no torque acts that did not act in them.

    What did not move the drive a moment before, nor a moment after, does not move it in between: the velocity that
    shows there is its sensor's, as lasting noise is.

    Args:
        recording: with a torque.
        mask: where it rests, shape (N,).
        velocity: smoothed, shape (N,).
        slow: what is small [rad/s or m/s].
    """
    torque, joined = recording.driving_torque, mask.copy()
    for (start, end), (begin, stop) in pairwise(pieces(recording, mask)):
        if recording.run[start] != recording.run[begin] or np.any(np.abs(velocity[end:begin]) > slow):
            continue
        least, most = (extreme(np.r_[torque[start:end], torque[begin:stop]]) for extreme in (np.min, np.max))
        if np.all((torque[end:begin] >= least) & (torque[end:begin] <= most)):
            joined[end:begin] = True
    return joined


def pieces(recording: Recording, mask: Mask) -> Iterator[tuple[int, int]]:
    """Yield start and stop of each piece of an uninterrupted stretch where a mask holds."""
    for part in stretches(recording.time, recording.run):
        edges = np.flatnonzero(np.diff(np.r_[0, mask[part].astype(np.int8), 0])) + part.start
        yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def _within_sensor(recording: Recording) -> float:
    """Return by how much two positions of a drive at rest may differ: by noise, or by one step of the sensor."""
    position = recording["position"]
    spread = BAND * np.sqrt(2.0) * noise_of(recording.time, position, recording.run).deviation
    return max(float(spread), 1.01 * quantum(position))
