"""What a run under a controller was worth: tracking error, effort, and whether the drive comes to rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.rig.physics import compiled

_REVERSALS = 3
"""Turns of the motion, by more than a count, in the last half of a rest that make it an oscillation, not a creep."""
_DECAYED = 0.7
"""An oscillation whose last quarter of the rest spans less than this share of the quarter before is dying out."""


@dataclass(frozen=True)
class Figures:
    """Figures of one run, SI.

    Attributes:
        rms_error, largest_error: of reference less true position, over all of the run [rad or m].
        rms_torque: of the motor torque [N m or N]. rms_torque_change: of its change from sample to sample.
        rest_span: greatest less least true position in the last half of the rest [rad or m].
        rest_counts: the same in counts of the encoder; NaN without one.
        swings: whether it still swings in the last half of the rest, by more than the encoder can show.
        limit_cycle: whether it swings on, and does not die out.
        rest_error: RMS of the reference less true position in the last half of the rest.
    """

    rms_error: float
    largest_error: float
    rms_torque: float
    rms_torque_change: float
    rest_span: float
    rest_counts: float
    swings: bool
    limit_cycle: bool
    rest_error: float


def figures(wanted: Array, position: Array, torque: Array, resting: int, encoder_step: float, least: float) -> Figures:
    """Return the figures of a run.

    Args:
        wanted, position, torque: at each sample, shape (N,).
        resting: index of the first sample of the final rest.
        encoder_step: 0 for a perfect encoder.
        least: motion at rest that counts, where there is no encoder [rad or m].
    """
    error = wanted - position
    half = resting + (len(position) - resting) // 2
    span, counts, swings, lasts = _rest(position[half:], encoder_step or least)
    return Figures(
        rms_error=_rms(error),
        largest_error=float(np.max(np.abs(error))),
        rms_torque=_rms(torque),
        rms_torque_change=_rms(np.diff(torque)),
        rest_span=span,
        rest_counts=counts if encoder_step > 0 else float("nan"),
        swings=swings,
        limit_cycle=lasts,
        rest_error=_rms(error[half:]),
    )


def _rest(position: Array, step: float) -> tuple[float, float, bool, bool]:
    """Return the span of the motion at rest, in SI and in steps, whether it swings, and whether that is a limit cycle.

    It swings where the position turns at least three times, by more than a step each time; a contact that creeps by
    less than can be seen does not. It is a limit cycle where that does not die out: the last half spans at least 0.7 of
    what the first does.
    """
    if len(position) < 4:
        return 0.0, 0.0, False, False
    if not np.all(np.isfinite(position)):
        return float("inf"), float("inf"), True, True
    span = float(np.ptp(position))
    middle = len(position) // 2
    early, late = float(np.ptp(position[:middle])), float(np.ptp(position[middle:]))
    swings = bool(turns(position, step) >= _REVERSALS)
    return span, span / step, swings, swings and late > step and late >= _DECAYED * early


@compiled
def turns(position: Any, least: float) -> int:
    """Return how often a motion turns round, by more than ``least`` on either side."""
    low = high = position[0]
    direction, found = 0, 0
    for value in position:
        low, high = min(low, value), max(high, value)
        if direction <= 0 and value > low + least:
            found -= direction
            direction, high = 1, value
        elif direction >= 0 and value < high - least:
            found += direction
            direction, low = -1, value
    return found


def _rms(values: Array) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")
