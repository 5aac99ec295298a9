"""The motion that a drive is to follow: a multisine, moves with rests between them, and a rest at the end."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from fricmodels.arrays import Array
from fricmodels.rig.excitation import between_speeds
from fricmodels.signals.integrated import way

Kind: TypeAlias = Literal["both", "multisine", "trapezoid"]
LINES = 4
"""Harmonics of the multisine."""
PERIODS = 5
"""Periods of the multisine, the first and the last of which fade in and out."""
MOVES = 14


@dataclass(frozen=True)
class Reference:
    """A motion in closed form, from rest to rest.

    Attributes:
        phases: of the harmonics of the multisine. weights: their amplitudes in velocity [rad/s]; both may be empty.
        frequency: of the first harmonic [Hz].
        knots: instants at which the acceleration of the moves changes [s], after the multisine. speeds: at the knots.
        moving: time from which on it rests for good [s]. duration: of all [s].
    """

    phases: Array
    weights: Array
    frequency: float
    knots: Array
    speeds: Array
    moving: float
    duration: float

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration at any times, each of shape (N,)."""
        found = np.empty((3, len(time)))
        before = time < self.knots[0]
        found[:, before], found[:, ~before] = self._multisine(time[before]), self._moves(time[~before])
        return found[0], found[1], found[2]

    @property
    def peak(self) -> float:
        """Greatest speed, as sampled at a thousandth of a period."""
        time = np.linspace(0.0, self.duration, int(1000 * self.duration * max(self.frequency, 1 / self.duration)) + 1)
        return float(np.max(np.abs(self.at(time)[1])))

    def _multisine(self, time: Array) -> tuple[Array, Array, Array]:
        """Return the sum of sines times a window that rises and falls as a smooth step within a period."""
        q, w, a = (np.zeros_like(time) for _ in range(3))
        for number, (phase, weight) in enumerate(zip(self.phases, self.weights, strict=True), start=1):
            omega = 2 * math.pi * number * self.frequency
            q += weight / omega * np.sin(omega * time + phase)
            w += weight * np.cos(omega * time + phase)
            a -= weight * omega * np.sin(omega * time + phase)
        first, rise = float(self.knots[0]), 1 / self.frequency
        up, slope_up, bend_up = _smooth_step(time / rise)
        down, slope_down, bend_down = _smooth_step((first - time) / rise)
        window, slope = up * down, (slope_up * down - up * slope_down) / rise
        bend = (bend_up * down - 2 * slope_up * slope_down + up * bend_down) / rise**2
        return q * window, w * window + q * slope, a * window + 2 * w * slope + q * bend

    def _moves(self, time: Array) -> tuple[Array, Array, Array]:
        over = time >= self.knots[-1]
        at_end = (way(self.knots, self.speeds)[-1], 0.0, 0.0)
        values = between_speeds(time, self.knots, self.speeds)
        return tuple(np.where(over, e, v) for e, v in zip(at_end, values, strict=True))  # type: ignore[return-value]


def reference(
    rng: np.random.Generator, speed: float, frequency: float, travel: float, rest: float, kind: Kind = "both"
) -> Reference:
    """Draw a motion.

    Args:
        rng: source of phases, goals, speeds and rests.
        speed: of the fastest move, and about the peak of the multisine [rad/s or m/s].
        frequency: of a move forth and back; that of the multisine's first harmonic is half of it [Hz].
        travel: the moves stay within ± so much [rad or m].
        rest: at the end [s].
        kind: ``multisine``, ``trapezoid``, or ``both``, one after the other.
    """
    numbers = np.arange(1, LINES + 1)
    phases = rng.uniform(0, 2 * math.pi, LINES)
    weights = 1 / numbers
    weights = speed / 2 * weights / np.sqrt(np.mean(weights**2)) / math.sqrt(2)
    first = PERIODS / (0.5 * frequency) if kind != "trapezoid" else 0.0
    knots, speeds, t, here, side = [first], [0.0], first, 0.0, 1.0
    acceleration = 2 * math.pi * frequency * speed
    for _ in range(MOVES if kind != "multisine" else 0):
        goal = side * travel * rng.uniform(0.3, 1.0)
        distance = abs(goal - here)
        fast = min(speed * math.exp(rng.uniform(math.log(0.2), 0.0)), math.sqrt(distance * acceleration))
        ramp, pause = fast / acceleration, math.exp(rng.uniform(math.log(0.05), 0.0)) / frequency
        cruise = max(distance / fast - ramp, 0.0)
        for length, after in ((ramp, fast), (cruise, fast), (ramp, 0.0), (0.5 * pause, 0.0)):
            if t + length > t:  # a cruise of no length is no knot
                t += length
                knots.append(t)
                speeds.append(math.copysign(after, goal - here))
        here, side = goal, -side
    moving = max(first, knots[-1])
    knots.append(moving + rest)
    speeds.append(0.0)
    if kind == "trapezoid":
        phases, weights = phases[:0], weights[:0]
    return Reference(phases, weights, 0.5 * frequency, np.array(knots), np.array(speeds), moving, moving + rest)


def _smooth_step(x: Array) -> tuple[Array, Array, Array]:
    """Return 10x³ − 15x⁴ + 6x⁵ on [0, 1] and its first two derivatives; 0 before and 1 after."""
    x = np.clip(x, 0.0, 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2), 30 * x**2 * (1 - x) ** 2, 60 * x * (1 - x) * (1 - 2 * x)
