"""What the motion excites."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.logcheck.balance import CLUSTERS
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log

_AGAIN = 2.0 / CLUSTERS


def little(log: Log, noise: float) -> Iterator[Finding]:
    """Say where the motion is too little to tell friction from what it stands against.

    The speed must stand out of its noise: its RMS value is three times the noise's at least, the usual limit of
    detection (Currie 1968). The drive must move in at least two of 32 parts of the record, go both ways, and change
    its speed: else a constant torque, or viscous and Coulomb friction, are the same.
    """
    velocity = log.velocity
    at_rest = float(np.mean(np.abs(velocity) <= 3.0 * noise))
    speed = float(np.sqrt(np.mean(velocity**2)))
    if speed < 3.0 * noise:
        yield _finding(
            f"the velocity (RMS {speed:.2g} {log.length_unit}/s) does not stand out of its noise ({noise:.2g})"
        )
    elif at_rest > 1.0 - _AGAIN:
        yield _finding(f"{100 * at_rest:.3g} % of the velocities are within their noise of zero")
    elif log.one_way:
        yield _finding("the drive hardly ever turns back: Coulomb friction cannot be told from a constant torque")


def _finding(text: str) -> Finding:
    return Finding("little-motion", Severity.WARN, "velocity", text, "record more motion, in both directions")
