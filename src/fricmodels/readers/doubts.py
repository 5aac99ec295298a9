"""What is readable, and yet may not be what was meant: a velocity that is not the change of the position."""

from __future__ import annotations

import math

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.recording import Recording

_SCALE = 0.1
"""A rate off by a tenth is one of another unit, or of the other side of a gear."""
_FOLLOWS = 0.5
"""Less than this share of the windows agree where a rate is of some other motion."""
_AGREES = 0.2
"""Windows agree that differ by a fifth of the largest change; so much may be noise, and a wrapped angle is far more."""
_LENGTHS = (1, 4, 16, 64, 256)
_LEAST = 16
_KNOWN = {
    180 / math.pi: "as between degrees and radians",
    30 / math.pi: "as between rpm and rad/s",
    60.0: "as between seconds and minutes",
    360.0: "as between degrees and turns",
    2 * math.pi: "as between radians and turns",
    1000.0: "as between milli and one",
    1e6: "as between micro and one",
}


def doubts(recording: Recording) -> list[str]:
    """Return what speaks against the units or the columns of a recording, a line each.

    A measured velocity must be the change of a measured position, and a measured acceleration that of the velocity,
    in units and in sign. A gear between the sensors makes them differ too, so that this is no error.
    """
    source = recording.provenance.get("source", recording.name)
    return [
        f"{source}: {doubt}"
        for quantity, rate in (("position", "velocity"), ("velocity", "acceleration"))
        if quantity in recording and rate in recording and rate not in recording.derived
        if (doubt := _of_rate(recording, quantity, rate))
    ]


def _of_rate(recording: Recording, quantity: str, rate: str) -> str:
    """Return how a rate differs from the change of its quantity; nothing if it does not, or if it cannot be told."""
    values, measured = recording[quantity], recording[rate]
    within = np.diff(recording.run) == 0
    steps = np.where(within, 0.5 * (measured[1:] + measured[:-1]) * np.diff(recording.time), 0.0)
    area = np.concatenate([[0.0], np.cumsum(steps)])
    tried = [_compared(values, area, recording.run, length) for length in _LENGTHS]
    found = [outcome for outcome in tried if outcome is not None]
    if not found:
        return ""
    scale, share = max(found, key=lambda outcome: outcome[1])
    columns = recording.provenance.get("columns", {})
    names = f"{rate} ({columns.get(rate, rate)})", f"{quantity} ({columns.get(quantity, quantity)})"
    if share < _FOLLOWS:
        return f"the {names[0]} does not follow the change of the {names[1]}; check which columns they are"
    if abs(scale - 1) <= _SCALE:
        return ""
    if scale < 0:
        return f"the {names[0]} is {scale:.3g} times the change of the {names[1]}; turn the sign of one of them"
    factor = max(scale, 1 / scale)
    known = next((f", {why}" for value, why in _KNOWN.items() if abs(factor / value - 1) < 0.02), "")
    return (
        f"the {names[0]} is {scale:.3g} times the change of the {names[1]}{known}; "
        f"give their units, as in --column {rate}=COLUMN:UNIT"
    )


def _compared(values: Array, area: Array, run: Index, length: int) -> tuple[float, float] | None:
    """Return the ratio of a rate to the change of its quantity over windows, and the share of windows that agree.

    The ratio is a median, since an angle may be wrapped; the windows are those of the larger half of the changes.

    Args:
        values: the quantity, shape (N,).
        area: integral of the rate from the beginning, shape (N,).
        run: number of each sample's run, shape (N,).
        length: of a window, in samples.
    """
    starts = np.arange(0, len(values) - length, length)
    starts = starts[run[starts] == run[starts + length]]
    if len(starts) < _LEAST:
        return None
    integral, change = area[starts + length] - area[starts], values[starts + length] - values[starts]
    large = (np.abs(integral) >= np.median(np.abs(integral))) & (integral != 0)
    counted = large & (change != 0)
    if np.count_nonzero(counted) < _LEAST // 2:
        return None
    scale = float(np.median(integral[counted] / change[counted]))
    miss = np.abs(integral - scale * change)
    return scale, float(np.mean(miss[large] < _AGREES * np.max(np.abs(integral))))
