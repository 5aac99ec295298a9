"""Hidden effects whose torque depends on the present state alone: speed, position, load, torque."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from fricmodels.dimension import Motion
from fricmodels.documents import Finite, Positive
from fricmodels.rig.hidden import (
    BROAD,
    CLOSED_LOOP,
    Drawn,
    Fraction,
    HiddenEffect,
    Share,
    Waves,
    either_sign,
    log_uniform,
)


class Asymmetry(Share):
    """Friction stronger forward by these shares, weaker backward."""

    name: Literal["asymmetry"] = "asymmetry"
    coulomb: Fraction = 0.0
    viscous: Fraction = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("coulomb", "viscous")
    needs_symmetry: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw both shares."""
        return {"coulomb": 0.1 * either_sign(rng) * rng.uniform(0.3, 1), "viscous": 0.1 * rng.uniform(-1, 1)}

    def enter(self, p: Any, waves: Waves) -> None:
        """Multiply forward by 1 + share, backward by 1 − share."""
        for name, share in (("coulomb", self.coulomb), ("rise", self.coulomb), ("viscous", self.viscous)):
            p[f"{name}_forward"] *= 1 + share
            p[f"{name}_backward"] *= 1 - share


class TorqueOffset(HiddenEffect):
    """A constant torque against the positive direction: a sensor's bias or an unknown constant load."""

    name: Literal["torque-offset"] = "torque-offset"
    torque: Finite
    sizes: ClassVar[tuple[str, ...]] = ("torque",)
    needs_symmetry: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the sign."""
        return {"torque": 0.1 * drive.friction * either_sign(rng)}

    def enter(self, p: Any, waves: Waves) -> None:
        """Add the constant."""
        p["offset"] += self.torque


class Stribeck(HiddenEffect):
    """Dry friction higher by ``rise`` at rest, falling as exp(−(|ω|/speed)^exponent)."""

    name: Literal["stribeck"] = "stribeck"
    rise: Finite
    speed: Positive
    exponent: Positive = 2.0
    sizes: ClassVar[tuple[str, ...]] = ("rise",)
    shown_by: ClassVar[tuple[str, ...]] = ("sine", "multisine", "tracking", "ramp", "stair")

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw speed and exponent."""
        return {
            "rise": 0.5 * drive.coulomb,
            "speed": drive.speed * log_uniform(rng, 0.04, 0.2),
            "exponent": float(rng.choice([1.0, 2.0])),
        }

    def enter(self, p: Any, waves: Waves) -> None:
        """Add the speed-weakening part."""
        p["stribeck_rise"], p["stribeck_speed"] = self.rise, self.speed
        p["stribeck_exponent"] = self.exponent


class NonlinearViscous(HiddenEffect):
    """A torque ``coefficient``·|ω|^exponent against the motion."""

    name: Literal["nonlinear-viscous"] = "nonlinear-viscous"
    coefficient: Finite
    exponent: Positive
    sizes: ClassVar[tuple[str, ...]] = ("coefficient",)
    shown_by: ClassVar[tuple[str, ...]] = ("sine", "multisine", "tracking", "ramp", "stair")

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the exponent."""
        exponent = float(rng.choice([0.5, 2 / 3, 2.0, 3.0]))
        return {"coefficient": 0.3 * drive.friction / drive.speed**exponent, "exponent": exponent}

    def enter(self, p: Any, waves: Waves) -> None:
        """Add the power of speed."""
        p["power_coefficient"], p["power_exponent"] = self.coefficient, self.exponent


class LoadFriction(HiddenEffect):
    """Dry friction that grows by ``coefficient`` times the load torque."""

    name: Literal["load-friction"] = "load-friction"
    coefficient: Finite
    sizes: ClassVar[tuple[str, ...]] = ("coefficient",)
    shown_by: ClassVar[tuple[str, ...]] = CLOSED_LOOP
    needs_load: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Return a tenth."""
        return {"coefficient": 0.1}

    def enter(self, p: Any, waves: Waves) -> None:
        """Add the share of the load."""
        p["load_friction"] += self.coefficient


class DirectionalEfficiency(HiddenEffect):
    """Gear losses: a share of the load torque lost when driving it, another when driven back by it."""

    name: Literal["directional-efficiency"] = "directional-efficiency"
    driving: Finite
    driven: Finite
    sizes: ClassVar[tuple[str, ...]] = ("driving", "driven")
    shown_by: ClassVar[tuple[str, ...]] = CLOSED_LOOP
    needs_load: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw both losses."""
        return {"driving": 0.2 * rng.uniform(0.6, 1), "driven": 0.2 * rng.uniform(0.0, 0.4)}

    def enter(self, p: Any, waves: Waves) -> None:
        """Add the losses."""
        p["driving_loss"] += self.driving
        p["driven_loss"] += self.driven


class TorqueGain(Share):
    """The shaft gets (1 + ``error``) times the recorded torque."""

    name: Literal["torque-gain"] = "torque-gain"
    error: Fraction
    sizes: ClassVar[tuple[str, ...]] = ("error",)
    shown_by: ClassVar[tuple[str, ...]] = BROAD
    needs_load: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the sign."""
        return {"error": 0.1 * either_sign(rng)}

    def enter(self, p: Any, waves: Waves) -> None:
        """Set the gain error."""
        p["gain"] += self.error


class InertiaError(Share):
    """The drive has (1 + ``error``) times the inertia that is stated."""

    name: Literal["inertia-error"] = "inertia-error"
    error: Fraction
    sizes: ClassVar[tuple[str, ...]] = ("error",)
    shown_by: ClassVar[tuple[str, ...]] = BROAD
    needs_load: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the sign."""
        return {"error": 0.1 * either_sign(rng)}

    def enter(self, p: Any, waves: Waves) -> None:
        """Multiply the inertia."""
        p["motor_inertia"] *= 1 + self.error
        p["load_inertia"] *= 1 + self.error


class Gravity(HiddenEffect):
    """An unbalanced weight, not in the recorded load: sine·sin q + cosine·cos q; friction takes the share ``loss``."""

    name: Literal["gravity"] = "gravity"
    sine: Finite = 0.0
    cosine: Finite = 0.0
    loss: Annotated[float, Field(ge=0)] = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("sine", "cosine")
    shown_by: ClassVar[tuple[str, ...]] = CLOSED_LOOP
    motions: ClassVar[tuple[Motion, ...]] = (Motion.ROTARY,)
    needs_turns: ClassVar[bool] = True

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the angle at which the weight hangs."""
        angle, weight = rng.uniform(0, 2 * np.pi), 0.15 * drive.friction
        return {"sine": weight * float(np.sin(angle)), "cosine": weight * float(np.cos(angle))}

    def enter(self, p: Any, waves: Waves) -> None:
        """Add the weight."""
        p["gravity_sine"] += self.sine
        p["gravity_cosine"] += self.cosine
        p["gravity_loss"] += self.loss


class Stiffness(HiddenEffect):
    """A spring, such as a cable: ``stiffness``·(q − neutral)."""

    name: Literal["stiffness"] = "stiffness"
    stiffness: Finite
    neutral: Finite = 0.0
    sizes: ClassVar[tuple[str, ...]] = ("stiffness",)
    shown_by: ClassVar[tuple[str, ...]] = CLOSED_LOOP

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the neutral position."""
        return {"stiffness": 0.1 * drive.friction / drive.travel, "neutral": drive.travel * rng.uniform(-0.5, 0.5)}

    def enter(self, p: Any, waves: Waves) -> None:
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

    @classmethod
    def drawn_amplitude(cls, drive: Drawn) -> float:
        """Return the amplitude of the first harmonic of an effect that is drawn."""
        return 0.15 * drive.friction

    def scaled(self, factor: float) -> Self:
        """Return the same waves with their amplitudes multiplied."""
        larger = tuple(w.model_copy(update={"amplitude": factor * w.amplitude}) for w in self.harmonics)
        return self.model_copy(update={"harmonics": larger})

    def parameters(self) -> dict[str, Any]:
        """Return each harmonic, with its wave number."""
        return {"harmonics": [{"k": w.k, "amplitude": w.amplitude, "phase": w.phase} for w in self.harmonics]}

    @classmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw one harmonic, and in one case of five another one of twice its order."""
        first, amplitude = wave_number(), cls.drawn_amplitude(drive)
        harmonics = [{"order": first, "amplitude": amplitude, "phase": rng.uniform(0, 2 * np.pi)}]
        if rng.random() < 0.2:
            harmonics.append({"order": 2 * first, "amplitude": 0.3 * amplitude, "phase": rng.uniform(0, 2 * np.pi)})
        return {"harmonics": harmonics}

    def enter(self, p: Any, waves: Waves) -> None:
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

    @classmethod
    def drawn_amplitude(cls, drive: Drawn) -> float:
        """Return a share of the motor torque."""
        return 0.1


TorqueEffect = (
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
)
"""Any effect of this module."""
