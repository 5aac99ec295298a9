"""A recording as the rows take it: not too long, with a smoothed velocity, an acceleration and its rests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.once import once
from fricmodels.recording import RATE, RUN, Origin, Recording
from fricmodels.signals import lanczos_derivative, resting, smoothed_velocity, smoothing_half_width, standstill
from fricmodels.signals.creeping import creeping_speed, creeping_stretches

MAX_SAMPLES = 163_840
"""Longer recordings are diagnosed on this many samples, in blocks spread evenly over them."""

_BLOCK = 8_192
_SHORT, _BLOCKS_MORE = 2.0, 2
"""Blocks that last less than so long [s] remember what was before them, for so many lengths of a block at most: three
times as many samples to integrate states along. In longer ones a state that begins anew is soon forgotten."""


@dataclass(frozen=True)
class Smoothed:
    """A recording with acceleration and torque rate, freed of noise: what does not depend on the model.

    With its rests, and where it moves so slowly that it may creep, see :func:`.creeping_stretches`.
    """

    recording: Recording
    velocity: Array
    half_width: int
    resting: Mask
    creeps: Sequence[tuple[int, int]] = ()


@once
def smoothed(recording: Recording) -> Smoothed:
    """Return a recording, or blocks of a long one, with its smoothed velocity and its rests."""
    part = spread(recording.with_channels(run=recording.signal(RUN)))
    half_width = smoothing_half_width(part)
    smooth, acceleration = lanczos_derivative(part.time, part.velocity, half_width, part.run)
    if "acceleration" not in part:
        part = part.with_channels(acceleration=acceleration)
    smooth = np.where(np.abs(smooth) <= standstill(smooth), 0.0, smooth)
    rates: dict[str, Any] = {RATE + name: part.signal(RATE + name) for name in part.further}
    part = part.with_channels(torque_rate=part.signal("motor_torque_rate"), **rates)
    rest = resting(part)
    return Smoothed(part, smooth, half_width, rest, creeping_stretches(part, smooth, rest, creeping_speed(smooth)))


def blocks_of(count: int) -> list[tuple[int, int]]:
    """Return the first sample, and the one after the last, of the blocks that stand for so many samples."""
    if count <= MAX_SAMPLES:
        return [(0, count)]
    starts = np.linspace(0, count - _BLOCK, MAX_SAMPLES // _BLOCK).astype(int)
    return [(start, start + _BLOCK) for start in starts.tolist()]


def spread(recording: Recording) -> Recording:
    """Return at most :data:`MAX_SAMPLES` samples, as blocks spread evenly over a longer recording.

    Short blocks remember the motion before them: states do not begin anew with each.
    """
    count = len(recording)
    if count <= MAX_SAMPLES:
        return recording
    pieces = blocks_of(count)
    index = np.concatenate([np.arange(start, stop) for start, stop in pieces])
    origin = recording.origin or Origin(recording, np.arange(count))
    chosen = replace(recording, origin=None).select(index)
    # Blocks are runs of their own; a block that spans two runs stays two.
    fresh = np.repeat(np.arange(len(pieces)), _BLOCK)
    run = _numbered(fresh, chosen.run)
    if _BLOCK * recording.interval > _SHORT:
        return replace(chosen, run=run)
    return replace(chosen, run=run, origin=_with_what_was_before(origin, [origin.index[a:b] for a, b in pieces]))


def _with_what_was_before(origin: Origin, blocks: list[Index]) -> Origin:
    """Return the samples of blocks and of what was just before them, its velocity smoothed and zero at rest.

    Args:
        origin: the recording that blocks were cut from, if need be through what was cut out.
        blocks: places of their samples in it.
    """
    whole = replace(origin.whole, origin=None)
    needed = np.zeros(len(whole), dtype=np.bool_)
    for block in blocks:
        needed[max(block[0] - _BLOCKS_MORE * _BLOCK, 0) : block[-1] + 1] = True
    pieces = np.cumsum(np.diff(needed.astype(np.int8), prepend=0) > 0, dtype=np.int64)[needed]
    before = whole.select(needed)
    before = replace(before, run=_numbered(pieces, before.run))
    still = np.where(resting(before), 0.0, smoothed_velocity(before)[0])
    before = before.with_channels(derived="velocity" in whole.derived, velocity=still)
    return Origin(before, (np.cumsum(needed) - 1)[np.concatenate(blocks)])


def _numbered(pieces: Index, runs: Index) -> Index:
    """Return a number for each run of each piece, shape (N,)."""
    changes = (np.diff(pieces, prepend=pieces[:1]) != 0) | (np.diff(runs, prepend=runs[:1]) != 0)
    return np.asarray(np.cumsum(changes, dtype=np.int64))
