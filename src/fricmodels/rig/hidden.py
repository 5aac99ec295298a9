"""What a hidden effect is: a size, and where it enters the physics."""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field

Waves = list[tuple[float, float, float, float]]
"""Periodic torques: kind, wave number k, amplitude, phase."""
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
    def enter(self, p: Any, waves: Waves) -> None:
        """Write the effect into the physical coefficients ``p`` and the table of periodic torques."""


class Share(HiddenEffect):
    """An effect whose sizes are shares of something, at most 0.9."""

    def largest(self, value: float) -> float:
        """Return a share of at most 0.9."""
        return min(max(value, -0.9), 0.9)
