"""Inertia of another joint, by the rate of its velocity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from fricmodels.effects.of_channel import MEANINGS, OfChannel
from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.recording import RATE, Recording
from fricmodels.results.experiments import OUT_OF_STEP
from fricmodels.term import Parameters, Signals

_RATES = {"rad/s": "rad/s^2", "m/s": "m/s^2"}


class OtherInertia(OfChannel):
    r"""A torque in proportion to the rate of a further channel x, the velocity of another joint.

    .. math:: \tau = c\,\dot x

    It is `other` for logs without accelerations. The rate is the central difference of the samples; what is compared
    with it is averaged over far more of them.

    Source: Elementary; M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control (2006), chapter 7.
    """

    name = "other-inertia"
    formula = "τ = c·dx/dt"
    signature = "in proportion to the acceleration of another joint"
    needs_motion = "another joint that moves, and not in step with this one"
    separated_from = {"inertia-error": OUT_OF_STEP}
    units = frozenset(_RATES)
    c = Parameter("c", unit="N m", per="x", meaning="torque per unit of dx/dt")

    @classmethod
    def candidates(cls, recording: Recording) -> Sequence[Self]:
        """Return the effect of each velocity, where no accelerations were recorded."""
        accelerations = set(_RATES.values()) & set(recording.units.values())
        return [] if accelerations else super().candidates(recording)

    def signals_of(self, channel: str) -> tuple[str, ...]:
        """Return the rate of the channel."""
        return (RATE + channel,)

    def parameter_unit(self, unit: str) -> str:
        """Return the unit of the rate."""
        return _RATES.get(unit, "")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c dx/dt."""
        return p.c * s[RATE + self.channel]

    @property
    def physics(self) -> str:
        """What the torque goes with, and what that most likely is."""
        return f"it goes with the rate of {self.described()}: {MEANINGS['rad/s^2']}"
