"""One drive, one reference, one controller: what each way of compensating friction makes of the tracking error."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.kernels import Callback
from fricmodels.rig.closed_loop import Control, Driven, InLoop, closed_loop, known_loads, temperatures
from fricmodels.rig.excitation import ClosedLoop
from fricmodels.rig.inverse import true_torque
from fricmodels.rig.rig import Rig
from fricmodels.tracking.compensator import Compensator, place
from fricmodels.tracking.figures import Figures, figures
from fricmodels.tracking.reference import Reference, reference
from fricmodels.tracking.settings import Settings

_STREAM = 7
"""Random numbers of the tracking motion, apart from those of the identification recording."""
_REST_PERIODS = 12.0
_SHARE_OF_BANDWIDTH = 0.25
_FINE = 20
_SOFTER = 0.7
_TRIALS = 8


class Experiment:
    """A drive that has been identified, and is to follow another motion.

    It goes on where the identification ended: what warmed or drifted is warm. The reference moves about as fast and as
    far as the drive did in the identification, no faster than a quarter of the bandwidth. The gains are those of a
    commissioning: lowered until the drive without compensation neither runs away nor still swings at rest, not even
    with a swing that dies out: that is a margin.

    Args:
        rig: the drive, with its hidden effects.
        settings: of controller and motion.

    Raises:
        InputError: for a drive that did not move, or that no gains hold.
    """

    def __init__(self, rig: Rig, settings: Settings | None = None) -> None:
        self.rig, self.settings = rig, settings or Settings()
        self.origin = rig.runs * rig.samples / rig.rate
        self._moved = _Moved.of(rig)
        widest = self.settings.bandwidth or self.settings.widest()
        if self.settings.bandwidth is None and isinstance(rig.excitation, ClosedLoop):
            widest = min(widest, rig.excitation.bandwidth)
        self.reference = self._reference(widest)
        self.encoder_step = self.settings.step(self.reference.peak, rig.motion)
        self.bandwidth = widest
        if self.settings.bandwidth is None:
            self._commission()

    def _reference(self, bandwidth: float) -> Reference:
        moved = self._moved
        frequency = min(moved.frequency, _SHARE_OF_BANDWIDTH * bandwidth)
        speed = min(moved.speed, 2 * math.pi * frequency * moved.travel)
        rng = np.random.default_rng([self.rig.seed, self.settings.seed, _STREAM])
        travel = min(moved.travel, 2 * speed / (2 * math.pi * frequency))
        return reference(rng, speed, frequency, travel, max(1.0, _REST_PERIODS / bandwidth), self.settings.motion)

    def _commission(self) -> None:
        for _ in range(_TRIALS):
            run = self.run(None)
            if math.isfinite(run.figures.rms_error) and not run.figures.swings:
                return
            self.bandwidth *= _SOFTER
            self.__dict__.pop("control", None)
        raise InputError(f"rig '{self.rig.name}': no gains were found with which it comes to rest")

    @cached_property
    def control(self) -> Control:
        """The controller."""
        return self.settings.control(self.rig.inertia, self.bandwidth, self.encoder_step)

    @cached_property
    def time(self) -> Array:
        """Sample times from the start of the motion [s], shape (N,)."""
        return np.arange(int(self.reference.duration * self.settings.rate)) / self.settings.rate

    @cached_property
    def _ahead(self) -> Array:
        """Middle of the interval in which the torque of each sample acts: the reference is known beforehand."""
        return self.time + self.control.delay + 0.5 * self.control.interval

    @cached_property
    def _phase(self) -> float:
        return float(np.random.default_rng([self.rig.seed, self.settings.seed, _STREAM, 1]).uniform(0, 2 * math.pi))

    def _load(self, time: Array) -> Array:
        """Return the load that is put on from outside; its weight as a payload is not in it."""
        load = self.rig.load
        if load is None:
            return np.zeros(len(time))
        return np.asarray(load.bias + load.amplitude * np.sin(2 * math.pi * load.frequency * time + self._phase))

    @cached_property
    def _signals(self) -> dict[str, Array]:
        """What a controller knows where its torque acts, along the reference."""
        position, velocity, acceleration = self.reference.at(self._ahead)
        p, clock = self.rig._physics(), self.origin + self._ahead
        return {
            "position": position,
            "velocity": velocity,
            "acceleration": acceleration,
            "load_torque": known_loads(p, position, self._load(self._ahead)),
            "temperature": temperatures(p, clock),
            "time": clock,
        }

    @cached_property
    def base(self) -> Array:
        """Feed-forward without friction: stated inertia times acceleration, and the known load, shape (N,)."""
        return self.rig.inertia * self._signals["acceleration"] + self._signals["load_torque"]

    def compensator(self, drive: Drive, values: Mapping[str, float], width: float) -> Compensator:
        """Return the compensation by a model, as the settings have it.

        Args:
            drive: the model. values: its parameters by key. width: its width of rest.
        """
        how = self.settings
        if how.at == "reference":
            return Compensator(drive, values, width, stated=self.rig.inertia)
        turn = how.turn * self.reference.peak
        return Compensator(drive, values, width, at_rest=how.at_rest, turn=turn, stated=self.rig.inertia)

    def run(self, compensator: Compensator | None) -> Run:
        """Drive along the reference with a compensation, or without."""
        if compensator is None:
            return self._driven(self.base)
        rows = compensator.rows(self.control.interval, self.base, self._signals["velocity"], self._signals)
        if self.settings.at == "reference":
            return self._driven(self.base + compensator.along(rows))
        within = InLoop(
            compensator.pointer,
            rows,
            place("velocity"),
            place("position"),
            compensator.memory,
            compensator.constants,
        )
        return self._driven(self.base, within)

    def run_true(self) -> Run:
        """Drive along the reference with the torque that the simulated drive's own equations ask for."""
        interval = self.control.interval
        fine = (self.time[:, None] + self.control.delay + interval * (np.arange(_FINE) + 0.5) / _FINE).ravel()
        fine = np.concatenate([np.arange(0.5, round(self.control.delay / interval * _FINE)) * interval / _FINE, fine])
        motion = np.column_stack(self.reference.at(fine))
        needed = true_torque(self.rig, interval / _FINE, motion, self._load(fine), origin=self.origin)
        return self._driven(needed[len(fine) - _FINE * len(self.time) :].reshape(-1, _FINE).mean(axis=1))

    def _driven(self, feedforward: Array, within: InLoop | None = None) -> Run:
        position = self.reference.at(self.time)[0]
        driven = closed_loop(
            self.rig,
            self.control,
            position,
            feedforward,
            self._load(self.time),
            within or _idle(len(feedforward)),
            active=within is not None,
            origin=self.origin,
        )
        resting = math.ceil(self.reference.moving * self.settings.rate)
        least = 1e-6 * float(np.ptp(position))
        found = figures(position, driven.position, driven.torque, resting, self.encoder_step, least)
        return Run(position, driven, found)


@dataclass(frozen=True)
class Run:
    """One run: wanted position, what the drive did, and what it was worth."""

    wanted: Array
    driven: Driven
    figures: Figures


@dataclass(frozen=True)
class _Moved:
    """How fast [rad/s], how far [rad] to either side, and at which frequency [Hz] the drive moved when identified."""

    speed: float
    travel: float
    frequency: float

    @classmethod
    def of(cls, rig: Rig) -> _Moved:
        velocity = np.concatenate([h.velocity for h in rig.histories])
        position = np.concatenate([h.position for h in rig.histories])
        history = rig.histories[0]
        step = history.interval * len(history.torque) / len(history.velocity)
        slope = np.concatenate([np.diff(h.velocity) for h in rig.histories]) / step
        speed, rms = float(np.quantile(np.abs(velocity), 0.95)), float(np.sqrt(np.mean(velocity**2)))
        if not rms > 0:
            raise InputError(f"rig '{rig.name}' does not move: there is nothing to identify, and nothing to follow")
        travel = 0.5 * float(np.quantile(position, 0.95) - np.quantile(position, 0.05))
        return cls(speed, travel, float(np.sqrt(np.mean(slope**2))) / rms / (2 * math.pi))


def _idle(count: int) -> InLoop:
    """Return a compensation that is never called, for the loop's signature."""
    return InLoop(_nothing(), np.zeros((count, 1)), -1, -1, np.zeros(1), np.zeros(1))


@lru_cache(maxsize=1)
def _nothing() -> Any:
    import casadi

    one = [casadi.SX.sym(name) for name in ("state", "row", "constant")]
    return Callback(casadi.Function("nothing", one, [one[0], casadi.SX(0)])).pointer
