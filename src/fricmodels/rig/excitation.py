"""How a simulated drive is moved: open-loop torques, and motions that a controller follows.

Every excitation gives, at N sample times, a torque to apply or a position and velocity to follow. Amplitudes are in
SI units: N m (N), rad (m), rad/s (m/s), Hz, s.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from fricmodels.arrays import Array
from fricmodels.documents import Positive
from fricmodels.signals.integrated import way


@dataclass(frozen=True)
class Command:
    """What the drive is told: open-loop ``torque``, or ``position``, ``velocity``, ``acceleration`` to follow."""

    torque: Array
    position: Array
    velocity: Array
    acceleration: Array


class Excitation(BaseModel):
    """A way of moving the drive; ``kind`` names it."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    closed_loop: ClassVar[bool] = False

    @abstractmethod
    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return the command at the sample times."""


class Sine(Excitation):
    """A sinusoidal motor torque (the paper's)."""

    kind: Literal["sine"] = "sine"
    amplitude: Positive
    frequency: Positive
    bias: float = 0.0

    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return amplitude·sin(2π frequency t) + bias."""
        return _open(self.amplitude * np.sin(2 * np.pi * self.frequency * time) + self.bias)


class Multisine(Excitation):
    """A motor torque of ``lines`` equal harmonics of ``frequency``, of random phase; RMS is ``amplitude``/√2."""

    kind: Literal["multisine"] = "multisine"
    amplitude: Positive
    frequency: Positive
    lines: Annotated[int, Field(ge=1, le=200)] = 7

    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return the sum of cosines."""
        phases = rng.uniform(0, 2 * np.pi, self.lines)
        total = np.zeros_like(time)
        for line, phase in enumerate(phases, start=1):
            total += np.cos(2 * np.pi * line * self.frequency * time + phase)
        return _open(self.amplitude / np.sqrt(self.lines) * total)


class ClosedLoop(Excitation):
    """A motion followed by a PD controller with inertia feed-forward."""

    closed_loop: ClassVar[bool] = True
    bandwidth: Positive
    """Frequency of the controlled position [Hz]."""
    damping_ratio: Positive = 0.8


class Tracking(ClosedLoop):
    """Follow a position of ``lines`` harmonics of ``frequency``; ``velocity`` is √2 times the RMS velocity."""

    kind: Literal["tracking"] = "tracking"
    velocity: Positive
    frequency: Positive
    lines: Annotated[int, Field(ge=1, le=200)] = 5

    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return a sum of cosines and its derivatives; higher harmonics are weaker by 1/n in velocity."""
        numbers = np.arange(1, self.lines + 1)
        phases = rng.uniform(0, 2 * np.pi, self.lines)
        weights = 1 / numbers
        weights = self.velocity * weights / np.sqrt(np.sum(weights**2))
        q, w, a = (np.zeros_like(time) for _ in range(3))
        for number, phase, weight in zip(numbers, phases, weights, strict=True):
            omega = 2 * np.pi * number * self.frequency
            q += weight / omega * np.sin(omega * time + phase)
            w += weight * np.cos(omega * time + phase)
            a -= weight * omega * np.sin(omega * time + phase)
        return Command(np.zeros_like(time), q, w, a)


class Trapezoid(ClosedLoop):
    """Moves of trapezoidal velocity within ``span``, with rests of random length between (``rests``: least, most).

    Each move's speed is drawn between ``slowest`` and 1 times ``velocity``.
    """

    kind: Literal["trapezoid"] = "trapezoid"
    velocity: Positive
    acceleration: Positive
    span: Positive
    rests: tuple[Annotated[float, Field(ge=0)], Positive] = (0.05, 0.5)
    slowest: Annotated[float, Field(gt=0, le=1)] = 0.4

    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return moves between random points, alternately up and down so that every move reverses."""
        knots, speeds, t, place, side = [time[0]], [0.0], float(time[0]), 0.0, 1.0
        low, high = np.log(max(self.rests[0], 1e-3)), np.log(self.rests[1])
        while t < time[-1]:
            goal = side * self.span * rng.uniform(0.15, 0.5)
            distance = abs(goal - place)
            speed = min(self.velocity * rng.uniform(self.slowest, 1.0), np.sqrt(distance * self.acceleration))
            ramp = speed / self.acceleration
            cruise = max(distance / speed - ramp, 0.0)
            rest = float(np.exp(rng.uniform(low, high)))
            direction = np.sign(goal - place)
            for duration, after in ((ramp, speed), (cruise, speed), (ramp, 0.0), (rest, 0.0)):
                t += duration
                knots.append(t)
                speeds.append(direction * after)
            place, side = goal, -side
        return _from_velocity(time, np.array(knots), np.array(speeds))


class Stair(ClosedLoop):
    """Constant speeds from ``slowest`` to 1 times ``velocity``, each held for ``hold`` seconds, forward and back."""

    kind: Literal["stair"] = "stair"
    velocity: Positive
    acceleration: Positive
    hold: Positive
    levels: Annotated[int, Field(ge=1, le=1000)] = 8
    slowest: Annotated[float, Field(gt=0, le=1)] = 0.05

    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return speed levels in random order, each forward then backward."""
        levels = self.velocity * np.geomspace(self.slowest, 1.0, self.levels)
        knots, speeds, t = [time[0]], [0.0], float(time[0])
        while t < time[-1]:
            for level in rng.permutation(levels):
                for signed in (level, -level):
                    for duration, after in (
                        (level / self.acceleration, signed),
                        (self.hold, signed),
                        (level / self.acceleration, 0.0),
                    ):
                        t += duration
                        knots.append(t)
                        speeds.append(after)
        return _from_velocity(time, np.array(knots), np.array(speeds))


class Ramp(ClosedLoop):
    """Velocity rising and falling linearly between ± ``velocity`` in ``period`` seconds: slow reversals and creep."""

    kind: Literal["ramp"] = "ramp"
    velocity: Positive
    period: Positive

    def command(self, time: Array, rng: np.random.Generator) -> Command:
        """Return a triangular velocity whose peaks are drawn between half and full."""
        cycles = int(np.ceil((time[-1] - time[0]) / self.period)) + 1
        start = time[0]
        quarters = np.arange(4 * cycles + 1)
        peaks = np.repeat(rng.uniform(0.5, 1.0, cycles), 4)
        pattern = np.array([0.0, 1.0, 0.0, -1.0])[quarters % 4]
        peaks = np.append(peaks, 0.0)
        return _from_velocity(time, start + 0.25 * self.period * quarters, self.velocity * peaks * pattern)


AnyExcitation = Annotated[
    Sine | Multisine | Tracking | Trapezoid | Stair | Ramp,
    Field(discriminator="kind"),
]
"""Any excitation, chosen by its kind."""


def _open(torque: Array) -> Command:
    zero = np.zeros_like(torque)
    return Command(torque, zero, zero, zero)


def _from_velocity(time: Array, knots: Array, speeds: Array) -> Command:
    order = np.concatenate([[True], np.diff(knots) > 0])
    knots, speeds = knots[order], speeds[order]
    return Command(np.zeros_like(time), *between_speeds(time, knots, speeds))


def between_speeds(time: Array, knots: Array, speeds: Array) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration of a motion whose velocity is linear between knots, from zero on."""
    slopes, place = np.diff(speeds) / np.diff(knots), way(knots, speeds)
    segment = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(slopes) - 1)
    since = time - knots[segment]
    velocity = speeds[segment] + slopes[segment] * since
    position = place[segment] + speeds[segment] * since + 0.5 * slopes[segment] * since**2
    return position, velocity, slopes[segment]
