"""Positions that jump back by a whole turn, or by the range of a counter, and go on."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals.noise_level import quantum

_USUAL = {"a turn": 2.0 * math.pi, "360": 360.0}
_UNUSUAL = {"two turns": 4.0 * math.pi, "half a turn": math.pi, "180": 180.0}
_NEAR = 0.02
"""A jump is a wrap if it is of the period but for a fiftieth: a position that jumps by chance does so in one case of
twenty-five, and nearly all its jumps must: but one in fifty, for one beside lost samples."""
_MOST = 0.98


@dataclass(frozen=True)
class Wrap:
    """How a position is wrapped.

    Attributes:
        period: by which it jumps, in the unit of the position.
        name: of the period.
        jumps: how often.
    """

    period: float
    name: str
    jumps: int


def find_wrap(values: Array, run: Index, time: Array | None = None, *, rotary: bool = True) -> Wrap | None:
    """Return how a position is wrapped, or ``None``.

    A jump is a step of more than half the range. Each, less the usual step beside it, taken as often as usual intervals
    go into its own where samples are missing, must be of one period: a turn or 360; or, where there are several jumps,
    two turns, half a turn or a power of two of the steps of a counter. All other steps must be less than a quarter of
    it, so that what is wrapped is known to go on.
    """
    change = np.where(np.diff(run) == 0, np.diff(values), 0.0)
    size = np.abs(change)
    span = float(np.ptp(values)) if len(values) else 0.0
    at = np.flatnonzero(size > 0.5 * span)
    if not len(at) or span == 0.0 or len(at) > len(values) // 4:
        return None
    going = np.where(size > 0.5 * span, 0.0, change)
    before, after = going[np.maximum(at - 1, 0)], going[np.minimum(at + 1, len(change) - 1)]
    usual = np.where(np.abs(before) <= np.abs(after), before, after)
    if time is not None and (interval := float(np.median(np.diff(time)))) > 0.0:
        usual = usual * np.maximum(np.round(np.diff(time)[at] / interval), 1.0)
    jump = np.abs(change[at] - usual)
    others = size[np.delete(np.arange(len(size)), at)]
    for name, period in _periods(values, rotary, len(at) > 1).items():
        if np.mean(np.abs(jump - period) < _NEAR * period) >= _MOST and float(others.max(initial=0.0)) < 0.25 * period:
            return Wrap(period, name, len(at))
    return None


def _periods(values: Array, rotary: bool, several: bool) -> dict[str, float]:
    periods = dict(_USUAL) if rotary else {}
    if not several:
        return periods
    periods |= _UNUSUAL if rotary else {}
    step = quantum(values[: 1 << 15])
    if step > 0.0:
        bits = math.log2(max(float(np.ptp(values)) / step, 1.0))
        if bits > 6.0:
            periods[f"{math.ceil(bits)} bits"] = step * 2.0 ** math.ceil(bits - 1e-3)
    return periods


def unwrapped(values: Array, run: Index, wrap: Wrap) -> Array:
    """Return the position as it goes on; it begins anew with each run."""
    change = np.diff(values)
    turns = np.where(np.diff(run) == 0, np.round(change / wrap.period), 0.0)
    return np.asarray(values - wrap.period * np.r_[0.0, np.cumsum(turns)])


def unwrap(recording: Recording) -> Recording:
    """Return the recording with its position unwrapped; its provenance then says ``unwrapped``, with the period."""
    if not recording.measures("position"):
        return recording
    position = recording["position"]
    wrap = find_wrap(position, recording.run, recording.time, rotary=recording.motion is Motion.ROTARY)
    if wrap is None:
        return recording
    known = {"period": wrap.period, "name": wrap.name, "jumps": wrap.jumps}
    return replace(
        recording,
        channels={**recording.channels, "position": unwrapped(position, recording.run, wrap)},
        provenance={**recording.provenance, "unwrapped": known},
    )
