"""Hidden effects with a memory or a motion of their own, and those of time and temperature."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field

from fricmodels.rig.hidden import Finite, HiddenEffect, Positive, Share, Waves


class Presliding(HiddenEffect):
    """Elastic contacts of ``width`` [rad] carry the dry friction: Dahl, LuGre or four Maxwell-slip blocks.

    ``damping_ratio`` is that of the drive swinging on its contacts.
    """

    name: Literal["presliding"] = "presliding"
    kind: Literal["dahl", "lugre", "maxwell-slip"] = "maxwell-slip"
    width: Positive
    damping_ratio: Annotated[float, Field(ge=0)] = 0.3
    sizes: ClassVar[tuple[str, ...]] = ("width",)

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

    def scaled(self, factor: float) -> Self:
        """Return a joint whose resonance is nearer: twist at a given torque grows by ``factor``."""
        return self.model_copy(update={"frequency": self.frequency / math.sqrt(factor)})

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

    def enter(self, p: Any, waves: Waves) -> None:
        """Set the step."""
        p["step_time"], p["step_coulomb"], p["step_viscous"] = self.time, self.coulomb, self.viscous
