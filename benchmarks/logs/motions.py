"""Motions as engineers make them: references of the position, and what changes over time.

A motion is asked for ``reference(rng, rate, seconds, speed, travel)``: the position at each period of the controller,
with the peak speed and the travel of the make unless the motion has its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Random = np.random.Generator
Signal = Callable[[Array, Random, float], Array]
"""What changes over time: of the time [s], a source of what is random, and an angle by which waves are turned."""
TURN = 2 * np.pi


class Motion(Protocol):
    """A kind of motion."""

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""


def _blend(share: Array) -> Array:
    """Return a blend of fifth order from 0 to 1."""
    share = np.clip(share, 0.0, 1.0)
    return share**3 * (10 - 15 * share + 6 * share * share)


def _travelled(speed: Array, rate: float, acceleration: float) -> Array:
    """Return the position of a speed whose slope is limited, and whose corners are rounded over 20 ms."""
    slewed, now, most = np.empty_like(speed), 0.0, acceleration / rate
    for i, wanted in enumerate(speed):
        now += min(max(wanted - now, -most), most)
        slewed[i] = now
    width = max(int(0.02 * rate), 1)
    return np.cumsum(np.convolve(slewed, np.ones(width) / width, "same")) / rate


@dataclass(frozen=True)
class PointToPoint:
    """Moves of fifth order between places drawn over the travel, and rests; speeds between 30 and 100 %."""

    dwell: float = 0.4
    speed: float | None = None

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""
        speed, count = self.speed or speed, int(seconds * rate)
        parts, now, length = [], 0.0, 0
        while length < count:
            goal = rng.uniform(-travel / 2, travel / 2)
            way = abs(goal - now)
            if way < 0.1 * travel:
                continue
            steps = int(way / (speed * rng.uniform(0.3, 1)) * 1.875 * rate) + 1
            rest = int(self.dwell * rng.uniform(0.3, 1.5) * rate)
            parts += [now + (goal - now) * _blend(np.arange(steps) / steps), np.full(rest, goal)]
            now, length = goal, length + steps + rest
        return np.concatenate(parts)[:count]


@dataclass(frozen=True)
class Fourier:
    """A periodic sum of five sines, the excitation of robot identification; amplitudes and phases are drawn."""

    frequency: float = 0.1

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""
        time = np.arange(int(seconds * rate)) / rate
        position = np.zeros_like(time)
        for order in range(1, 6):
            size, phase = rng.normal() / order, rng.uniform(0, 6.28)
            position += size * np.sin(TURN * order * self.frequency * time + phase)
        position *= _blend(time)
        position -= position[0]
        fastest = np.max(np.abs(np.gradient(position))) * rate
        return np.asarray(position * min(speed / fastest, travel / np.ptp(position)))


@dataclass(frozen=True)
class Steps:
    """Constant speeds to and fro with rests between, from slow to fast, over at most the travel."""

    shares: Sequence[float] = (0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
    """Speeds over the peak speed."""
    travel: float | None = None
    rest: float = 0.2

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""
        acceleration, travel = 5 * speed, self.travel or travel
        each, parts = seconds / len(self.shares), []
        for share in self.shares:
            now, total = share * speed, 0.0
            held = min(travel / now + now / acceleration, each / 2)
            while total < each - 1e-9:
                for side in (1, -1):
                    parts += [np.full(int(held * rate), side * now), np.zeros(int(self.rest * rate))]
                total += 2 * (held + self.rest)
        count = int(seconds * rate)
        wanted = np.concatenate(parts)[:count]
        return _travelled(np.pad(wanted, (0, count - len(wanted))), rate, acceleration)


@dataclass(frozen=True)
class Jog:
    """Somebody at the buttons: one of four speeds for 0.3 to 2 s either way, and pauses."""

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""
        count = int(seconds * rate)
        wanted, now, i = np.zeros(count), 0.0, int(0.3 * rate)
        while i < count:
            steps = int(rng.uniform(0.3, 2) * rate)
            chosen = rng.choice([0.1, 0.25, 0.5, 1]) * speed * rng.choice([-1, 1]) * rng.uniform(0.6, 1)
            if abs(now + chosen * steps / rate) > travel / 2:
                chosen = -chosen
            if abs(now + chosen * steps / rate) > travel / 2:
                steps = max(int(steps / 4), 10)
            wanted[i : i + steps] = chosen
            now += chosen * steps / rate
            i += steps + int(rng.uniform(0, 0.8) * rate)
        return _travelled(wanted, rate, 4 * speed)


@dataclass(frozen=True)
class Sine:
    """One sine of the position."""

    amplitude: float
    frequency: float

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""
        time = np.arange(int(seconds * rate)) / rate
        return np.asarray(self.amplitude * np.sin(TURN * self.frequency * time) * _blend(time / 0.5))


@dataclass(frozen=True)
class Chirp:
    """A sine of the speed whose frequency rises."""

    first: float
    last: float
    speed: float

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position that is asked for, shape (N,)."""
        time = np.arange(int(seconds * rate)) / rate
        angle = TURN * (self.first * time + (self.last - self.first) * time**2 / 2 / seconds)
        return np.asarray(np.cumsum(self.speed * np.sin(angle)) / rate * _blend(time / 0.5))


@dataclass(frozen=True)
class OpenLoop:
    """No controller: a torque is commanded, and the drive goes where it goes."""

    torque: Signal

    def reference(self, rng: Random, rate: float, seconds: float, speed: float, travel: float) -> Array:
        """Return the position from which it begins, shape (N,)."""
        return np.zeros(int(seconds * rate))


def waves(*each: tuple[float, float, float]) -> Signal:
    """Return a sum of sines, each an amplitude, a frequency [Hz] and a phase [rad]."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        return np.asarray(sum(size * np.sin(TURN * rate * time + phase + turned) for size, rate, phase in each))

    return signal


def square(size: float, frequency: float, phase: float) -> Signal:
    """Return a wave that jumps between two sizes."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        return np.asarray(size * np.sign(np.sin(TURN * frequency * time + phase + turned)))

    return signal


def warming(drop: float, time_constant: float) -> Signal:
    """Return a factor that falls from 1 to 1 − drop, as temperature rises."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        return np.asarray(1 - drop * (1 - np.exp(-time / time_constant)))

    return signal


def thinning(kelvin: float, time_constant: float, scale: float) -> Signal:
    """Return the factor exp(−ΔT/scale) of a lubricant's viscosity, as its temperature rises by so many kelvin."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        return np.asarray(np.exp(-kelvin * (1 - np.exp(-time / time_constant)) / scale))

    return signal


def jump(rise: float, at: float) -> Signal:
    """Return a factor that is 1, and 1 + rise after a moment [s]."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        return np.asarray(1 + rise * (time > at))

    return signal


def walk(size: float) -> Signal:
    """Return a factor that walks at random from 1 by so much in a second, between 0.3 and 3."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        steps = rng.normal(0, 1, len(time)) * np.sqrt(time[1] - time[0])
        return np.asarray(np.clip(1 + size * np.cumsum(steps), 0.3, 3))

    return signal


def catches(size: float, count: int) -> Signal:
    """Return a drag that grows and goes at random moments, as that of a cable which catches."""

    def signal(time: Array, rng: Random, turned: float) -> Array:
        moments = np.sort(rng.uniform(0, time[-1], count))
        return np.asarray(size * np.interp(time, moments, rng.choice([0.0, 1.0, 0.0, -0.7], count)))

    return signal
