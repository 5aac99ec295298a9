"""Seven kinds of motion as references of position, velocity and acceleration."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Segments = list[tuple[float, float, float]]
"""Speed as a share of the peak, time of the change to it, time that it is held; times in base periods."""


def _uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high))


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _point_to_point(rng: np.random.Generator) -> Segments:
    speed = _uniform(rng, 0.3, 1)
    return [(speed, 0.15, _uniform(rng, 0.05, 0.5)), (0.0, 0.15, _log(rng, 0.05, 1.0))]


def _trapezoids(rng: np.random.Generator) -> Segments:
    speed, held = _log(rng, 0.1, 1), _uniform(rng, 0.2, 0.5)
    return [(speed, 0.12, held), (-speed, 0.24, held), (0.0, 0.12, 0.0)]


def _steps(rng: np.random.Generator) -> Segments:
    return [(_uniform(rng, -1, 1), 0.08, _uniform(rng, 0.1, 0.5))]


def _sweeps(rng: np.random.Generator) -> Segments:
    speed, slow = _log(rng, 0.1, 1), _uniform(rng, 0.6, 1.5)
    return [(speed, slow, 0.0), (-speed, 2 * slow, 0.0), (0.0, slow, 0.0)]


def _jogging(rng: np.random.Generator) -> Segments:
    jogs: Segments = []
    speed = _log(rng, 0.1, 1)
    for _ in range(int(rng.integers(1, 4))):
        jogs += [(speed, 0.06, _uniform(rng, 0.05, 0.2)), (0.0, 0.06, _uniform(rng, 0.03, 0.3))]
    return jogs


SEGMENTS: Mapping[str, Callable[[np.random.Generator], Segments]] = {
    "point-to-point": _point_to_point,
    "trapezoids": _trapezoids,
    "steps": _steps,
    "sweeps": _sweeps,
    "jogging": _jogging,
}
MOTIONS = ("multisine", "sine", *SEGMENTS)


def reference(
    rng: np.random.Generator, kind: str, speed: float, period: float, duration: float, rate: float, travel: float
) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration, shapes (N,).

    Args:
        rng: source of what is random.
        kind: one of :data:`MOTIONS`.
        speed: peak speed [rad/s or m/s].
        period: base period [s].
        duration: of the run [s].
        rate: of the controller [Hz].
        travel: distance from the middle within which the motion stays, roughly; infinite for a spindle.
    """
    time = np.arange(round(duration * rate)) / rate
    if kind in SEGMENTS:
        velocity = _joined(rng, SEGMENTS[kind], speed, period, time, travel)
    else:
        lines = 1 if kind == "sine" else int(rng.integers(4, 8))
        own = np.array([1.0]) if lines == 1 else np.exp(np.linspace(np.log(0.4), np.log(4.0), lines))
        if lines > 1:
            own = own * np.exp(rng.uniform(-0.1, 0.1, lines))
        size = own**-0.3
        phase = rng.uniform(0, 2 * np.pi, lines)
        velocity = np.sum(size[:, None] * np.sin(2 * np.pi * own[:, None] * time / period + phase[:, None]), axis=0)
        velocity *= speed / np.max(np.abs(velocity))
    position = np.r_[0.0, np.cumsum(0.5 * (velocity[1:] + velocity[:-1]))] / rate
    if np.isfinite(travel):
        position -= 0.5 * (position.max() + position.min())
    return position, velocity, np.gradient(velocity) * rate


def _joined(
    rng: np.random.Generator,
    draw: Callable[[np.random.Generator], Segments],
    speed: float,
    period: float,
    time: Array,
    travel: float,
) -> Array:
    """Return a velocity through segments; the direction is chosen so that the position stays within the travel."""
    at, now, place = 0.0, 0.0, 0.0
    times, speeds = [0.0], [0.0]
    while at < time[-1]:
        part = draw(rng)
        way = 1.0 if rng.random() < 0.5 else -1.0
        if np.isfinite(travel) and place * way * np.sign(part[0][0] or 1.0) > 0.3 * travel:
            way = -way
        for share, change, held in part:
            wanted = way * share * speed
            room = travel - place * np.sign(wanted)
            if wanted and np.isfinite(travel):
                held = min(held, max(room, 0.0) / abs(wanted) / period)
            for target, lasts in ((wanted, change), (wanted, held)):
                if lasts > 0:
                    at += lasts * period
                    place += 0.5 * (now + target) * lasts * period
                    now = target
                    times.append(at)
                    speeds.append(now)
    velocity = np.interp(time, times, speeds)
    width = max(int(0.04 * period / (time[1] - time[0])), 1)
    smooth = np.convolve(np.pad(velocity, (width, width), mode="edge"), np.ones(width) / width, mode="same")
    return np.asarray(smooth[width:-width])
