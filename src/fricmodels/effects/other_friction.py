"""Friction of a part that moves with a further channel."""

from __future__ import annotations

from fricmodels.effects.of_channel import OfChannel
from fricmodels.expressions import Expression, where
from fricmodels.parameter import Parameter
from fricmodels.term import Parameters, Signals


class OtherFriction(OfChannel):
    r"""Coulomb and viscous friction of a part that moves with a further channel x, a velocity.

    .. math:: \tau = c\,x + d \operatorname{sgn} x

    A motor that turns with the sum of two joints, as in many wrists, has its friction in the sum of their velocities.
    At x = 0 the part holds or pushes as it likes, and nothing is counted.

    Source: Elementary; published in this form for the coupled wrist of the Stäubli TX40 (figaroh-examples, fvm6 and
    fsm6).
    """

    name = "other-friction"
    formula = "τ = c·x + d·sgn x"
    signature = "a step where the other part turns, and a slope over its speed"
    needs_motion = "another joint that turns at other instants than this one"
    units = frozenset({"rad/s", "m/s"})
    separated_from = {"other": "the other joint moved alone, at several speeds"}
    c = Parameter("c", unit="N m", per="x", meaning="viscous friction in x")
    d = Parameter("d", unit="N m", meaning="Coulomb friction in x")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c x + d sgn x, with sgn 0 = 0; x is recorded, so that its sign needs no smooth one."""
        x = s[self.channel]
        return p.c * x + p.d * (where(x > 0, 1, 0) - where(x < 0, 1, 0))

    @property
    def physics(self) -> str:
        """What the torque goes with."""
        return f"friction of a part that moves with {self.described()}, not of this joint's own motion"
