"""Hidden effects with a memory or a motion of their own, and those of time and temperature."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from fricmodels.documents import Finite, Positive
from fricmodels.rig.hidden import (
    CLOSED_LOOP,
    Drawn,
    HiddenEffect,
    Share,
    Waves,
    either_sign,
    log_uniform,
)


class Presliding(HiddenEffect):
    """Elastic contacts of ``width`` [rad] carry the dry friction: Dahl, LuGre or four Maxwell-slip blocks.

    ``damping_ratio`` is that of the drive swinging on its contacts.
    """

    name: Literal["presliding"] = "presliding"
    kind: Literal["dahl", "lugre", "maxwell-slip"] = "maxwell-slip"
    width: Positive
    damping_ratio: Annotated[float, Field(ge=0)] = 0.3
    sizes: ClassVar[tuple[str, ...]] = ("width",)
    shown_by: ClassVar[tuple[str, ...]] = CLOSED_LOOP

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw kind, width and damping."""
        return {
            "kind": str(rng.choice(["dahl", "lugre", "maxwell-slip"])),
            "width": drive.travel * log_uniform(rng, 0.005, 0.05),
            "damping_ratio": rng.uniform(0.1, 0.6),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Choose the contact and its width."""
        p["presliding"] = {"dahl": 1.0, "lugre": 2.0, "maxwell-slip": 3.0}[self.kind]
        p["elastic_width"] = self.width
        dry = max(p["coulomb_forward"], p["coulomb_backward"])
        p["micro_damping"] = 2 * self.damping_ratio * math.sqrt(p["motor_inertia"] * dry / self.width)


class FrictionalLag(HiddenEffect):
    """Frictional memory: the friction's dependence on speed follows ``delay`` seconds later (Hess and Soom)."""

    name: Literal["frictional-lag"] = "frictional-lag"
    delay: Positive
    sizes: ClassVar[tuple[str, ...]] = ("delay",)
    shown_by: ClassVar[tuple[str, ...]] = ("sine", "multisine", "tracking")
    needs_falling_friction: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the delay."""
        return {"delay": log_uniform(rng, 0.002, 0.02) / drive.frequency}

    def enter(self, p: Any, waves: Waves) -> None:
        """Set the delay."""
        p["lag"] = self.delay


class RisingStiction(HiddenEffect):
    """Breakaway torque that grows with the time t at rest by rise·t/(t + time), worn off over ``distance``."""

    name: Literal["rising-stiction"] = "rising-stiction"
    rise: Finite
    time: Positive
    distance: Positive
    sizes: ClassVar[tuple[str, ...]] = ("rise",)
    shown_by: ClassVar[tuple[str, ...]] = ("trapezoid",)

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the distance."""
        return {
            "rise": 0.5 * drive.coulomb,
            "time": 0.3 / drive.frequency,
            "distance": drive.travel * log_uniform(rng, 0.05, 0.3),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Set growth and wear."""
        p["ageing_rise"], p["ageing_time"], p["ageing_distance"] = self.rise, self.time, self.distance


class Backlash(HiddenEffect):
    """A gap of ``gap`` [rad] before the load, which has its shares of inertia and friction; contacts are stiff."""

    name: Literal["backlash"] = "backlash"
    gap: Positive
    load_inertia_share: Annotated[float, Field(gt=0, lt=1)] = 0.5
    load_friction_share: Annotated[float, Field(ge=0, lt=1)] = 0.5
    contact_frequency: Positive
    damping_ratio: Positive = 0.3
    sizes: ClassVar[tuple[str, ...]] = ("gap",)
    shown_by: ClassVar[tuple[str, ...]] = CLOSED_LOOP

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw gap, load and contact."""
        return {
            "gap": drive.travel * log_uniform(rng, 0.02, 0.1),
            "load_inertia_share": rng.uniform(0.3, 0.7),
            "load_friction_share": rng.uniform(0.3, 0.7),
            "contact_frequency": drive.rate * rng.uniform(0.2, 0.5),
            "damping_ratio": rng.uniform(0.4, 1.0),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Divide the drive in two bodies with a gap between."""
        _divide(p, self.load_inertia_share, self.load_friction_share, self.contact_frequency, self.damping_ratio)
        p["gap"] = self.gap


class JointCompliance(HiddenEffect):
    """A spring between motor and load: their resonance (both free) is at ``frequency`` [Hz]."""

    name: Literal["joint-compliance"] = "joint-compliance"
    frequency: Positive
    load_inertia_share: Annotated[float, Field(gt=0, lt=1)] = 0.5
    load_friction_share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    damping_ratio: Annotated[float, Field(ge=0)] = 0.02
    sizes: ClassVar[tuple[str, ...]] = ()
    shown_by: ClassVar[tuple[str, ...]] = ("trapezoid", "stair")

    def scaled(self, factor: float) -> Self:
        """Return a joint whose resonance is nearer: twist at a given torque grows by ``factor``."""
        return self.model_copy(update={"frequency": self.frequency / math.sqrt(factor)})

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw resonance, load and damping."""
        return {
            "frequency": drive.bandwidth * rng.uniform(3, 6),
            "load_inertia_share": rng.uniform(0.3, 0.7),
            "damping_ratio": log_uniform(rng, 0.01, 0.1),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Divide the drive in two bodies with a spring between."""
        _divide(p, self.load_inertia_share, self.load_friction_share, self.frequency, self.damping_ratio)


def _divide(p: Any, inertia_share: float, friction_share: float, frequency: float, damping_ratio: float) -> None:
    total = float(p["motor_inertia"])
    p["motor_inertia"], p["load_inertia"] = (1 - inertia_share) * total, inertia_share * total
    p["motor_share"] = 1 - friction_share
    reduced = inertia_share * (1 - inertia_share) * total
    natural = 2 * math.pi * frequency
    p["coupling_stiffness"] = reduced * natural**2
    p["coupling_damping"] = 2 * damping_ratio * reduced * natural


class SensorDelay(HiddenEffect):
    """What ``channel`` records happened ``delay`` seconds before."""

    name: Literal["sensor-delay"] = "sensor-delay"
    delay: Positive
    channel: Literal["motion", "torque"] = "motion"
    sizes: ClassVar[tuple[str, ...]] = ("delay",)
    shown_by: ClassVar[tuple[str, ...]] = ("multisine", "tracking")

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the delay, and what is late."""
        return {"delay": log_uniform(rng, 1, 6) / drive.rate, "channel": str(rng.choice(["motion", "torque"]))}

    def enter(self, p: Any, waves: Waves) -> None:
        """Nothing in the drive itself: the sensors apply it."""


class Thermal(HiddenEffect):
    """Warming from ``start`` to ``end`` °C, as 1 − e^(−t/time), thins viscous and dry friction."""

    name: Literal["thermal"] = "thermal"
    start: Finite = 20.0
    end: Finite
    time: Positive
    viscous: Finite = 0.0
    coulomb: Finite = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("viscous", "coulomb")

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the warming, and what it does."""
        return {
            "end": rng.uniform(35, 60),
            "time": drive.duration * rng.uniform(0.3, 1),
            "viscous": 0.01,
            "coulomb": 0.004 * rng.uniform(0, 1),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Set the warming and what it does: viscous·exp(−viscous·(T−T₀)), dry·(1 − coulomb·(T−T₀))."""
        p["temperature_start"], p["temperature_end"], p["temperature_time"] = self.start, self.end, self.time
        p["reference_temperature"] = 0.5 * (self.start + self.end)
        p["viscous_thinning"], p["coulomb_thinning"] = self.viscous, self.coulomb


class Drift(Share):
    """Friction changes by these shares as 1 − e^(−t/time), without a sensor for the cause."""

    name: Literal["drift"] = "drift"
    viscous: Finite = 0.0
    coulomb: Finite = 0.0
    time: Positive
    sizes: ClassVar[tuple[str, ...]] = ("viscous", "coulomb")

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw both shares and the time."""
        share = 0.3 * either_sign(rng)
        return {
            "viscous": share * rng.uniform(0, 1),
            "coulomb": share,
            "time": drive.duration * rng.uniform(0.5, 2),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Set the slow change."""
        p["viscous_drift"], p["coulomb_drift"], p["drift_time"] = self.viscous, self.coulomb, self.time


class StepChange(HiddenEffect):
    """At ``time`` dry friction rises by ``coulomb`` [N m] and the viscous coefficient by ``viscous`` [N m s/rad]."""

    name: Literal["step-change"] = "step-change"
    time: Annotated[float, Field(ge=0)]
    coulomb: Finite = 0.0
    viscous: Finite = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("coulomb", "viscous")

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the instant and the sign."""
        return {"time": drive.duration * rng.uniform(0.3, 0.7), "coulomb": 0.2 * drive.coulomb * either_sign(rng)}

    def enter(self, p: Any, waves: Waves) -> None:
        """Set the step."""
        p["step_time"], p["step_coulomb"], p["step_viscous"] = self.time, self.coulomb, self.viscous


MemoryEffect = (
    Presliding
    | FrictionalLag
    | RisingStiction
    | Backlash
    | JointCompliance
    | SensorDelay
    | Thermal
    | Drift
    | StepChange
)
"""Any effect of this module."""
