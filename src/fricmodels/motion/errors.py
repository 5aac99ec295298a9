"""How far a simulated motion is from the measured one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fricmodels.arrays import rms
from fricmodels.motion.simulator import Simulator


@dataclass(frozen=True)
class MotionErrors:
    """Errors of a simulated motion: simulated less measured.

    Attributes:
        position, velocity: RMS [rad or m; rad/s or m/s]; not a number where the simulation ended before the recording.
        position_percent, velocity_percent: of the RMS deviation of the measured position from its mean, and of the
            RMS velocity.
        position_mean_absolute: mean absolute error of the position.
        drift: mean position error; a force that is wrong by a constant shows here.
        worst: largest absolute error of the position.
        horizon: samples of a window; ``None`` in a free run.
        samples: how many were scored: all but the first of each run.
    """

    position: float
    velocity: float
    position_percent: float
    velocity_percent: float
    position_mean_absolute: float
    drift: float
    worst: float
    horizon: int | None
    samples: int

    def as_dict(self) -> dict[str, Any]:
        """Return the figures by name."""
        return asdict(self)


def motion_errors(simulator: Simulator, values: Mapping[str, float]) -> MotionErrors:
    """Simulate and say how far off it is.

    Args:
        simulator: of the recording that is scored.
        values: parameters by key.
    """
    position, velocity = simulator(values)
    measured, scored = simulator.recording, simulator.scored
    speed = (velocity - measured.velocity)[scored]
    known = measured.measures("position")
    where = (position - measured["position"])[scored] if known else np.full(len(speed), math.nan)
    spread = float(np.std(measured["position"][scored])) if known else math.nan
    away = rms(where)
    return MotionErrors(
        away,
        rms(speed),
        100 * away / spread if spread > 0 else math.nan,
        _share(rms(speed), rms(measured.velocity[scored])),
        float(np.mean(np.abs(where))),
        float(np.mean(where)),
        float(np.max(np.abs(where))),
        simulator.horizon,
        int(np.count_nonzero(scored)),
    )


def _share(error: float, size: float) -> float:
    return 100 * error / size if size > 0 else math.nan
