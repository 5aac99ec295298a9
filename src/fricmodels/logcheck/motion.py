"""What the motion excites."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmodels.arrays import rms
from fricmodels.logcheck.balance import CLUSTERS
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.results.words import figures
from fricmodels.signals.coasting import coasts
from fricmodels.signals.counted import step_of_counts
from fricmodels.signals.integrated import is_integral, way
from fricmodels.signals.lanczos import lanczos_derivative
from fricmodels.signals.noise_level import best_half_width

_AGAIN = 2.0 / CLUSTERS
_DIFFERENT = 0.1
"""RMS difference of two courses, as a share of the position's, below which they count as one."""

_MORE = "record more motion, in both directions"


def little(log: Log, noise: float) -> Iterator[Finding]:
    """Say where the motion is too little to tell friction from what it stands against.

    The speed must stand out of its noise: its RMS value is three times the noise's at least, the usual limit of
    detection (Currie 1968). The drive must move in at least two of 32 parts of the record, go both ways, and change
    its speed: else a constant torque, or viscous and Coulomb friction, are the same.
    """
    velocity = log.velocity
    at_rest = float(np.mean(np.abs(velocity) <= 3.0 * noise))
    speed = rms(velocity)
    if speed < 3.0 * noise:
        yield _finding(
            f"the velocity (RMS {figures(speed)} {log.length_unit}/s) does not stand out of its noise "
            f"({figures(noise)})"
        )
    elif at_rest > 1.0 - _AGAIN:
        yield _finding(f"{figures(100 * at_rest, 3)} % of the velocities are within their noise of zero")
    elif log.one_way:
        more = "let it coast the other way as well, if it can turn so" if coasts(log.recording) else _MORE
        yield _finding("the drive hardly ever turns back: Coulomb friction cannot be told from a constant torque", more)


def one_frequency(log: Log) -> Iterator[Finding]:
    r"""Say where position and acceleration have one course, as in one sine.

    .. math:: x - \bar x = -\ddot x / \omega^2

    What goes with the position, the acceleration or a short delay then has one form, and no data tell them apart. The
    position is that of each uninterrupted stretch about its mean.
    """
    short = log.short
    time, velocity, run = short.recording.time, short.velocity, short.recording.run
    smooth, acceleration = lanczos_derivative(time, velocity, best_half_width(time, velocity, run), run)
    position = np.empty(len(time))
    for part in short.parts:
        given = "position" in short.measured
        position[part] = short.recording["position"][part] if given else way(time[part], smooth[part])
        position[part] -= np.mean(position[part])
        acceleration[part] -= np.mean(acceleration[part])
    size = float(acceleration @ acceleration)
    slope = float(acceleration @ position) / size if size > 0 else 0.0
    whole, left = (rms(course) for course in (position, position - slope * acceleration))
    if slope < 0.0 and left < _DIFFERENT * whole:
        frequency = 1.0 / (2.0 * np.pi * np.sqrt(-slope))
        yield Finding(
            "one-frequency",
            Severity.NOTE,
            "velocity",
            f"the motion is one sine of {figures(frequency)} Hz: position and acceleration have one course but for "
            f"{figures(100 * left / whole)} %, so that a spring, an inertia, a torque constant and a delay look alike",
            "record a second frequency as well",
        )


def without_position(log: Log) -> Iterator[Finding]:
    """Say that the integral of the velocity stands for the position, where that was not recorded, or is just that."""
    if "velocity" not in log.measured:
        return
    if "position" in log.measured and is_integral(log.recording):
        yield Finding(
            "no-position",
            Severity.NOTE,
            "position",
            f"the {log.called('position')} is the integral of the {log.called('velocity')}, with its noise: it is "
            "taken as computed, not as measured",
            "log the position of an encoder as well, if there is one",
        )
    if "position" not in log.measured and not step_of_counts(log.recording):
        yield Finding(
            "no-position",
            Severity.NOTE,
            "velocity",
            f"no position was recorded: the integral of the {log.called('velocity')} is taken for it, from zero at the "
            "first sample of each run",
            "log the position as well, to compare what goes with it between logs",
        )


def _finding(text: str, remedy: str = _MORE) -> Finding:
    return Finding("little-motion", Severity.WARN, "velocity", text, remedy)
