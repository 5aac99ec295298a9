"""What a law or an effect declares: its parameters and, where it has a memory, its states."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import Literal

from fricmodels.dimension import Dimension, Motion, parse_unit
from fricmodels.errors import InputError


@dataclass(frozen=True)
class Parameter:
    """One physical coefficient of a law or an effect.

    Attributes:
        symbol: how the coefficient is written and printed; the name under which ``torque`` finds it.
        unit: coherent SI unit for a rotary drive (``N m s/rad``); the linear one (``N s/m``) follows from it.
        initial: value in ``unit`` that an estimator starts from where it has nothing better.
        lower, upper: physical bounds in ``unit``. Where they are equal the parameter is a constant, such as the torque
            to which a power of a torque is referred: it has its unit, and is not estimated.
        at_least: symbol of another parameter of the same term that this one must not fall below
            (a stick torque is never below the slip torque).
        meaning: the quantity in words.
        scan: for a coefficient that enters nonlinearly, the dimensionless values to try first, in units of the
            recording's own scales (peak velocity, position range, duration); empty for linear ones.
        part_of_drive: whether it is a share of the law's friction or of the drive's inertia, and no more than these.
        less_of_drive: share of the drive's inertia that minus it may be; 0 where it has no such bound.
        accompanies: whether by itself it is not the effect, as damping is no contact that bends; its other torques are.
        doubtful_ends: bounds of the search at which the estimate suggests that the effect, one with internal states,
            imitates another effect; none where the end itself is a physical case. Of a ratio they are none unless
            they are declared.
        own_time: whether a time or a rate is the drive's own, as that of a resonance, however long was recorded;
            ``scan`` counts it in durations of no more than 20 000 samples.
        slow: whether it is the time of a change all along the record: no shorter than the least that ``scan`` tries.
            What ends sooner is how the record began.
        resonance: whether it is the angular frequency of a part that the drive carries along on a spring. Its
            natural frequency is at least √2 times that of the motion: below, it would swing twice as far as the drive.
        periodic: whether it is a wave number in position, to be searched for in the spectrum over position.
        not_between: two values between which a rotary drive's effect is another one, and is not sought: a wave of about
            one period a turn is gravity.
        instant: whether it is a point in time, not a duration.
        place: whether it is a point of the travel, not a length; ``scan`` then counts shares of the travel from its
            lower end, wherever the position has its zero.
        delay: whether it is the time by which motion and torque were recorded apart, a factor of the signal
            ``motor_torque_rate``; see :meth:`fricmodels.drive.Drive.timed`.
        per: unit of the further channel of which it is the torque per unit; empty for all other parameters. Such a
            channel is no quantity of this drive: its unit stays when those of the drive are scaled, so that ``unit``,
            and the dimension, leave it out.
    """

    symbol: str
    unit: str = "1"
    initial: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf
    at_least: str | None = None
    meaning: str = ""
    scan: tuple[float, ...] = ()
    part_of_drive: bool = False
    less_of_drive: float = 0.0
    accompanies: bool = False
    doubtful_ends: tuple[Literal["lower", "upper"], ...] | None = None
    own_time: bool = False
    slow: bool = False
    resonance: bool = False
    periodic: bool = False
    not_between: tuple[float, float] | None = None
    instant: bool = False
    place: bool = False
    delay: bool = False
    per: str = ""

    def __post_init__(self) -> None:
        if not self.lower <= self.initial <= self.upper:
            raise ValueError(f"parameter {self.symbol}: initial {self.initial} is outside [{self.lower}, {self.upper}]")
        if self.constant and not self.scan:
            object.__setattr__(self, "scan", (1.0,))  # a search has to begin somewhere; its bounds put it in place

    @property
    def constant(self) -> bool:
        """Whether there is nothing to estimate."""
        return self.lower == self.upper

    @cached_property
    def dimension(self) -> Dimension:
        """Dimension that the unit stands for."""
        return parse_unit(self.unit)

    def unit_for(self, motion: Motion) -> str:
        """Return the SI unit on a rotary drive or on a linear axis."""
        own = self.dimension.unit(motion)
        if not self.per:
            return own
        try:
            other = parse_unit(self.per)
        except InputError:
            other = None
        if other is not None and other.unit(motion) == self.per:
            return (self.dimension * other**-1).unit(motion)
        return f"{own}/({self.per})" if re.search(r"[ /]", self.per) else f"{own}/{self.per}"


@dataclass(frozen=True)
class State:
    """An internal state of a term with memory (a bristle deflection, a lagging friction torque).

    Attributes:
        symbol, unit, meaning: for messages and reports.
        initial: value at the first sample of a run.
        lower, upper: what it lies between; a beginning that is found from the torque is kept within.
        unknown_at_rest: whether a rest may end in another state than the recorded motion leads to, since less motion
            than sensors see changes it; the first value is then possible, too, see :mod:`.score.holding`.
    """

    symbol: str
    unit: str = "1"
    initial: float = 0.0
    meaning: str = ""
    lower: float = -math.inf
    upper: float = math.inf
    unknown_at_rest: bool = False

    @cached_property
    def dimension(self) -> Dimension:
        """Dimension that the unit stands for."""
        return parse_unit(self.unit)


_AT_BOUND = 1e-9


def at_bound(declared: Mapping[str, Parameter], values: Mapping[str, float | None]) -> list[str]:
    """Return the keys of estimates that stand at the end of what is physical.

    Args:
        declared: parameters by key.
        values: estimates by key.
    """
    found = []
    for key, parameter in declared.items():
        value = values.get(key)
        if value is None or not parameter.lower < parameter.upper:
            continue
        ends = [end for end in (parameter.lower, parameter.upper) if math.isfinite(end)]
        if any(abs(value - end) <= _AT_BOUND * max(abs(end), _AT_BOUND) for end in ends):
            found.append(key)
    return found


def outside_bounds(declared: Mapping[str, Parameter], values: Mapping[str, float | None]) -> dict[str, str]:
    """Return key → reason of each estimate beyond the end of what is physical, which not every estimator keeps.

    Args:
        declared: parameters by key.
        values: estimates by key.
    """
    found = {}
    for key, parameter in declared.items():
        value, lower, upper = values.get(key), parameter.lower, parameter.upper
        if value is None or not math.isfinite(value):
            continue
        end = lower if value < lower else upper if value > upper else None
        if end is not None and abs(value - end) > _AT_BOUND * max(abs(end), _AT_BOUND):
            found[key] = f"its value {value:.3g} lies outside its bounds, {lower:.3g} to {upper:.3g}"
    return found


def check_inertia(inertia: float | None) -> None:
    """Refuse an inertia that no drive has.

    Raises:
        InputError: for one that is not positive and finite.
    """
    if inertia is not None and not (isinstance(inertia, Real) and 0 < inertia < math.inf):
        raise InputError(f"inertia must be positive and finite, got {inertia!r}; leave it out to have it estimated")
