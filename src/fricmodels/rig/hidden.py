"""What a hidden effect is: a size, and where it enters the physics."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from fricmodels.dimension import Motion

Waves = list[tuple[float, float, float, float]]
"""Periodic torques: kind, wave number k, amplitude, phase."""
Fraction = Annotated[float, Field(gt=-1, lt=1)]

EXCITATIONS = ("sine", "multisine", "tracking", "trapezoid", "stair", "ramp")
CLOSED_LOOP = ("tracking", "trapezoid", "ramp")
BROAD = ("multisine", "tracking", "trapezoid")


@dataclass(frozen=True)
class Drawn:
    """A drive that was drawn at random, and the sizes that follow from it, in SI units."""

    inertia: float
    coulomb: float
    speed: float
    friction: float
    frequency: float
    rate: float
    samples: int
    travel: float
    bandwidth: float

    @property
    def duration(self) -> float:
        """Length of the record [s]."""
        return self.samples / self.rate


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def either_sign(rng: np.random.Generator) -> float:
    """Draw −1 or 1."""
    return float(rng.choice([-1.0, 1.0]))


class HiddenEffect(BaseModel):
    """One hidden effect; ``name`` is that of the effects table."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    sizes: ClassVar[tuple[str, ...]] = ()
    """Fields that are proportional to how strong the effect is."""
    shown_by: ClassVar[tuple[str, ...]] = EXCITATIONS
    """Kinds of motion that show it."""
    motions: ClassVar[tuple[Motion, ...]] = tuple(Motion)
    """Drives that can have it."""
    needs_load: ClassVar[bool] = False
    """Whether only a drive with a load torque shows it."""
    needs_turns: ClassVar[bool] = False
    """Whether only a motion over more than a turn shows it."""
    needs_symmetry: ClassVar[bool] = False
    """Whether only friction that is equal in both directions tells it from a part of the law."""
    needs_falling_friction: ClassVar[bool] = False
    """Whether only friction that falls with speed shows it."""

    def scaled(self, factor: float) -> Self:
        """Return the same effect, stronger by ``factor``."""
        return self.model_copy(update={field: self.largest(factor * getattr(self, field)) for field in self.sizes})

    def largest(self, value: float) -> float:
        """Return a size cut to what is physical."""
        return value

    def parameters(self) -> dict[str, Any]:
        """Return everything but the name."""
        return self.model_dump(exclude={"name"})

    @classmethod
    @abstractmethod
    def draw(cls, rng: np.random.Generator, drive: Drawn, wave_number: Callable[[], float]) -> dict[str, Any]:
        """Draw the effect's fields for a drive; ``wave_number`` draws one of which the motion shows several periods."""

    @abstractmethod
    def enter(self, p: Any, waves: Waves) -> None:
        """Write the effect into the physical coefficients ``p`` and the table of periodic torques."""


class Share(HiddenEffect):
    """An effect whose sizes are shares of something, at most 0.9."""

    def largest(self, value: float) -> float:
        """Return a share of at most 0.9."""
        return min(max(value, -0.9), 0.9)
