"""What effects of a further channel have in common: a channel, its unit, and what it most likely is."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import ClassVar, Self

from fricmodels.errors import InputError
from fricmodels.recording import OTHER, Recording
from fricmodels.term import Effect, Term

_JOINT = re.compile(r"j(?:oint)?_?(\d+)_?(\w*)", re.IGNORECASE)


class OfChannel(Effect):
    """An effect of one further channel x of a recording, named in brackets: ``other(j2_acceleration)``.

    A class is the effect of any channel; one that is made is that of its own. Its parameters are torques per unit of
    the channel, which they learn from the recording; see :attr:`fricmodels.parameter.Parameter.per`.

    Args:
        channel: name without ``other.``.
        unit: SI unit of the channel; empty as long as none is known.
    """

    units: ClassVar[frozenset[str]] = frozenset()
    """SI units of the channels that it may be of; of any if empty."""
    with_angle: ClassVar[bool] = False
    """Whether it is a candidate only where this joint's angle was recorded."""

    symmetry = "even"
    absent = "the recording has no further channel of its kind"

    def __init__(self, channel: str = "x", unit: str = "") -> None:
        self.channel = OTHER + channel
        self.unit = unit
        self.name = f"{type(self).name}({channel})"
        self.formula = type(self).formula.replace("x", channel)
        self.channels = self.signals_of(self.channel)
        self.parameters = tuple(
            replace(p, per=self.parameter_unit(unit) or f"[{channel}]", meaning=p.meaning.replace("x", channel))
            if p.per
            else p
            for p in type(self).parameters
        )

    def signals_of(self, channel: str) -> tuple[str, ...]:
        """Return the signals that enter the torque: the channel, its rate, or both."""
        return (channel,)

    def parameter_unit(self, unit: str) -> str:
        """Return the unit of what the parameters are per unit of, from the channel's."""
        return unit

    @classmethod
    def named(cls, argument: str = "") -> Self:
        """Return the effect of a channel.

        Raises:
            InputError: without a channel.
        """
        if not argument:
            raise InputError(f"'{cls.name}' is of a further channel; name it: {cls.name}(CHANNEL)")
        return cls(argument.removeprefix(OTHER))

    @classmethod
    def candidates(cls, recording: Recording) -> Sequence[Self]:
        """Return the effect of each further channel whose unit fits."""
        if cls.with_angle and "position" not in recording:
            return []
        found = [(name.removeprefix(OTHER), recording.units.get(name, "")) for name in recording.further]
        return [cls(name, unit) for name, unit in found if not cls.units or unit in cls.units]

    def on(self, recording: Recording, beside: Sequence[Term] = ()) -> Self:
        """Return the effect with the unit that the channel has in a recording.

        Raises:
            InputError: where the effect is none of a channel in this unit.
        """
        unit = recording.units.get(self.channel, "")
        if self.channel in recording and self.units and unit not in self.units:
            raise InputError(
                f"'{self.name}' is of a channel in {' or '.join(sorted(self.units))}; '{self.channel}' is in "
                f"{unit or 'no unit'}: give it with --column {self.channel}=COLUMN:UNIT"
            )
        return type(self)(self.channel.removeprefix(OTHER), unit)

    def described(self) -> str:
        """Return the channel in words: ``the acceleration of joint 2 (channel j2_acceleration)``."""
        name = self.channel.removeprefix(OTHER)
        joint = _JOINT.fullmatch(name)
        if joint is None or not joint[2]:
            return f"the channel {name}"
        return f"the {joint[2].replace('_', ' ')} of joint {joint[1]} (channel {name})"


MEANINGS: Mapping[str, str] = {
    "rad/s^2": "rigid-body coupling, not friction",
    "m/s^2": "rigid-body coupling, not friction",
    "rad/s": "a part that turns with both joints and has friction, or damping between them",
    "m/s": "a part that moves with both joints and has friction, or damping between them",
    "rad": "gravity or a spring that hangs on where another joint stands, not friction",
    "m": "gravity or a spring that hangs on where another joint stands, not friction",
    "N m": "a load that comes over from another joint, not friction",
    "N": "a load that comes over from another joint, not friction",
    "degC": "it changes with the temperature",
}
"""What a torque in proportion to a channel most likely is, by the channel's SI unit."""
