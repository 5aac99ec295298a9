"""The effects that a simulated drive can hide: their sizes, and where they enter the physics.

Each class is one entry of ``effects:`` in a rig file. :meth:`HiddenEffect.enter` writes it into the record of
physical coefficients; :meth:`HiddenEffect.scaled` multiplies what makes it large or small. On a linear axis read N for
N m and m for rad.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

if TYPE_CHECKING:
    from fricmodels.rig.rig import Rig

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Fraction = Annotated[float, Field(gt=-1, lt=1)]


class HiddenEffect(BaseModel):
    """One hidden effect; ``name`` is that of the effects table."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    sizes: ClassVar[tuple[str, ...]] = ()
    """Fields that are proportional to how strong the effect is."""

    def scaled(self, factor: float) -> Self:
        """Return the same effect, stronger by ``factor``."""
        return self.model_copy(update={field: self.largest(factor * getattr(self, field)) for field in self.sizes})

    def largest(self, value: float) -> float:
        """Return a size cut to what is physical."""
        return value

    def parameters(self) -> dict[str, Any]:
        """Return everything but the name."""
        return self.model_dump(exclude={"name"})

    @abstractmethod
    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Write the effect into the physical coefficients ``p`` and the table of periodic torques."""


class _Share(HiddenEffect):
    def largest(self, value: float) -> float:
        """Return a share of at most 0.9."""
        return min(max(value, -0.9), 0.9)


class Asymmetry(_Share):
    """Friction stronger forward by these shares, weaker backward."""

    name: Literal["asymmetry"] = "asymmetry"
    coulomb: Fraction = 0.0
    viscous: Fraction = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("coulomb", "viscous")

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Multiply forward by 1 + share, backward by 1 − share."""
        for name, share in (("coulomb", self.coulomb), ("rise", self.coulomb), ("viscous", self.viscous)):
            p[f"{name}_forward"] *= 1 + share
            p[f"{name}_backward"] *= 1 - share


class TorqueOffset(HiddenEffect):
    """A constant torque against the positive direction: a sensor's bias or an unknown constant load."""

    name: Literal["torque-offset"] = "torque-offset"
    torque: Finite
    sizes: ClassVar[tuple[str, ...]] = ("torque",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the constant."""
        p["offset"] += self.torque


class Stribeck(HiddenEffect):
    """Dry friction higher by ``rise`` at rest, falling as exp(−(|ω|/speed)^exponent)."""

    name: Literal["stribeck"] = "stribeck"
    rise: Finite
    speed: Positive
    exponent: Positive = 2.0
    sizes: ClassVar[tuple[str, ...]] = ("rise",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the speed-weakening part."""
        p["stribeck_rise"], p["stribeck_speed"] = self.rise, self.speed
        p["stribeck_exponent"] = self.exponent


class NonlinearViscous(HiddenEffect):
    """A torque ``coefficient``·|ω|^exponent against the motion."""

    name: Literal["nonlinear-viscous"] = "nonlinear-viscous"
    coefficient: Finite
    exponent: Positive
    sizes: ClassVar[tuple[str, ...]] = ("coefficient",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the power of speed."""
        p["power_coefficient"], p["power_exponent"] = self.coefficient, self.exponent


class LoadFriction(HiddenEffect):
    """Dry friction that grows by ``coefficient`` times the load torque."""

    name: Literal["load-friction"] = "load-friction"
    coefficient: Finite
    sizes: ClassVar[tuple[str, ...]] = ("coefficient",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the share of the load."""
        p["load_friction"] += self.coefficient


class DirectionalEfficiency(HiddenEffect):
    """Gear losses: a share of the load torque lost when driving it, another when driven back by it."""

    name: Literal["directional-efficiency"] = "directional-efficiency"
    driving: Finite
    driven: Finite
    sizes: ClassVar[tuple[str, ...]] = ("driving", "driven")

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the losses."""
        p["driving_loss"] += self.driving
        p["driven_loss"] += self.driven


class TorqueGain(_Share):
    """The shaft gets (1 + ``error``) times the recorded torque."""

    name: Literal["torque-gain"] = "torque-gain"
    error: Fraction
    sizes: ClassVar[tuple[str, ...]] = ("error",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Set the gain error."""
        p["gain"] += self.error


class InertiaError(_Share):
    """The drive has (1 + ``error``) times the inertia that is stated."""

    name: Literal["inertia-error"] = "inertia-error"
    error: Fraction
    sizes: ClassVar[tuple[str, ...]] = ("error",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Multiply the inertia."""
        p["motor_inertia"] *= 1 + self.error
        p["load_inertia"] *= 1 + self.error


class Gravity(HiddenEffect):
    """An unbalanced weight, not in the recorded load: sine·sin q + cosine·cos q."""

    name: Literal["gravity"] = "gravity"
    sine: Finite = 0.0
    cosine: Finite = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("sine", "cosine")

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the weight."""
        p["gravity_sine"] += self.sine
        p["gravity_cosine"] += self.cosine


class Stiffness(HiddenEffect):
    """A spring, such as a cable: ``stiffness``·(q − neutral)."""

    name: Literal["stiffness"] = "stiffness"
    stiffness: Finite
    neutral: Finite = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("stiffness",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add the spring."""
        p["stiffness"], p["neutral_position"] = self.stiffness, self.neutral


class Wave(BaseModel):
    """One harmonic ``amplitude``·cos(k q + phase): k = ``order`` [1/rad or 1/m] or 2π/``period`` [rad or m]."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    amplitude: Finite
    order: Positive | None = None
    period: Positive | None = None
    phase: Finite = 0.0

    @model_validator(mode="after")
    def _one_of(self) -> Self:
        if (self.order is None) == (self.period is None):
            raise ValueError("give either 'order' or 'period'")
        return self

    @property
    def k(self) -> float:
        """Angular wave number."""
        return self.order if self.order is not None else 2 * math.pi / (self.period or 1.0)


class _Periodic(HiddenEffect):
    harmonics: tuple[Wave, ...] = Field(min_length=1)
    kind: ClassVar[float]

    def scaled(self, factor: float) -> Self:
        """Return the same waves with their amplitudes multiplied."""
        larger = tuple(w.model_copy(update={"amplitude": factor * w.amplitude}) for w in self.harmonics)
        return self.model_copy(update={"harmonics": larger})

    def parameters(self) -> dict[str, Any]:
        """Return each harmonic, with its wave number."""
        return {"harmonics": [{"k": w.k, "amplitude": w.amplitude, "phase": w.phase} for w in self.harmonics]}

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Add rows to the table of periodic torques."""
        waves.extend((self.kind, w.k, w.amplitude, w.phase) for w in self.harmonics)


class Cogging(_Periodic):
    """A torque periodic in position, the same in both directions (amplitudes in N m)."""

    name: Literal["cogging"] = "cogging"
    kind: ClassVar[float] = 0.0


class PositionFriction(_Periodic):
    """Dry friction periodic in position (amplitudes in N m)."""

    name: Literal["position-friction"] = "position-friction"
    kind: ClassVar[float] = 1.0


class TorqueRipple(_Periodic):
    """Commutation ripple: delivered is recorded torque times 1 + Σ amplitude·cos (amplitudes are shares)."""

    name: Literal["torque-ripple"] = "torque-ripple"
    kind: ClassVar[float] = 2.0


class Presliding(HiddenEffect):
    """Elastic contacts of ``width`` [rad] carry the dry friction: Dahl, LuGre or four Maxwell-slip blocks."""

    name: Literal["presliding"] = "presliding"
    kind: Literal["dahl", "lugre", "maxwell-slip"] = "maxwell-slip"
    width: Positive
    micro_damping: Annotated[float, Field(ge=0)] = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("width",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Choose the contact and its width."""
        p["presliding"] = {"dahl": 1.0, "lugre": 2.0, "maxwell-slip": 3.0}[self.kind]
        p["elastic_width"], p["micro_damping"] = self.width, self.micro_damping


class FrictionalLag(HiddenEffect):
    """Frictional memory: the friction's dependence on speed follows ``delay`` seconds later (Hess and Soom)."""

    name: Literal["frictional-lag"] = "frictional-lag"
    delay: Positive
    sizes: ClassVar[tuple[str, ...]] = ("delay",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Set the delay."""
        p["lag"] = self.delay


class RisingStiction(HiddenEffect):
    """Breakaway torque that grows with the time t at rest by rise·t/(t + time), worn off over ``distance``."""

    name: Literal["rising-stiction"] = "rising-stiction"
    rise: Finite
    time: Positive
    distance: Positive
    sizes: ClassVar[tuple[str, ...]] = ("rise",)

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
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

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
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

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
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

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
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

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Set the warming and what it does: viscous·exp(−viscous·(T−T₀)), dry·(1 − coulomb·(T−T₀))."""
        p["temperature_start"], p["temperature_end"], p["temperature_time"] = self.start, self.end, self.time
        p["reference_temperature"] = 0.5 * (self.start + self.end)
        p["viscous_thinning"], p["coulomb_thinning"] = self.viscous, self.coulomb


class Drift(_Share):
    """Friction changes by these shares as 1 − e^(−t/time), without a sensor for the cause."""

    name: Literal["drift"] = "drift"
    viscous: Finite = 0.0
    coulomb: Finite = 0.0
    time: Positive
    sizes: ClassVar[tuple[str, ...]] = ("viscous", "coulomb")

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Set the slow change."""
        p["viscous_drift"], p["coulomb_drift"], p["drift_time"] = self.viscous, self.coulomb, self.time


class StepChange(HiddenEffect):
    """At ``time`` dry friction rises by ``coulomb`` [N m] and the viscous coefficient by ``viscous`` [N m s/rad]."""

    name: Literal["step-change"] = "step-change"
    time: Annotated[float, Field(ge=0)]
    coulomb: Finite = 0.0
    viscous: Finite = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("coulomb", "viscous")

    def enter(self, p: Any, waves: list[tuple[float, float, float, float]], rig: Rig) -> None:
        """Set the step."""
        p["step_time"], p["step_coulomb"], p["step_viscous"] = self.time, self.coulomb, self.viscous


AnyEffect = Annotated[
    Asymmetry
    | TorqueOffset
    | Stribeck
    | NonlinearViscous
    | LoadFriction
    | DirectionalEfficiency
    | TorqueGain
    | InertiaError
    | Gravity
    | Stiffness
    | Cogging
    | PositionFriction
    | TorqueRipple
    | Presliding
    | FrictionalLag
    | RisingStiction
    | Backlash
    | JointCompliance
    | SensorDelay
    | Thermal
    | Drift
    | StepChange,
    Field(discriminator="name"),
]
"""Any hidden effect, chosen by its name."""
