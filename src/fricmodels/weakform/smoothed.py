"""A recording as the rows take it: not too long, with a smoothed velocity, an acceleration and its rests."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import RATE, RUN, Recording
from fricmodels.signals import lanczos_derivative, resting, smoothing_half_width, standstill
from fricmodels.signals.rest import once

MAX_SAMPLES = 163_840
"""Longer recordings are diagnosed on this many samples, in blocks spread evenly over them."""

_BLOCK = 8_192


@dataclass(frozen=True)
class Smoothed:
    """A recording with acceleration and torque rate, freed of noise: what does not depend on the model."""

    recording: Recording
    velocity: Array
    half_width: int
    resting: Mask


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
    return Smoothed(part, smooth, half_width, resting(part))


def blocks_of(count: int) -> list[tuple[int, int]]:
    """Return the first sample, and the one after the last, of the blocks that stand for so many samples."""
    if count <= MAX_SAMPLES:
        return [(0, count)]
    starts = np.linspace(0, count - _BLOCK, MAX_SAMPLES // _BLOCK).astype(int)
    return [(start, start + _BLOCK) for start in starts.tolist()]


def spread(recording: Recording) -> Recording:
    """Return at most :data:`MAX_SAMPLES` samples, as blocks spread evenly over a longer recording."""
    count = len(recording)
    if count <= MAX_SAMPLES:
        return recording
    pieces = blocks_of(count)
    blocks, index = len(pieces), np.concatenate([np.arange(start, stop) for start, stop in pieces])
    chosen = replace(recording, origin=None).select(index)
    # Blocks are runs of their own; a block that spans two runs stays two.
    fresh = np.repeat(np.arange(blocks), _BLOCK)
    _, run = np.unique(np.column_stack([fresh, chosen.run]), axis=0, return_inverse=True)
    return replace(chosen, run=run.astype(np.int64).ravel())
