"""A torque in proportion to a further channel."""

from __future__ import annotations

from fricmodels.effects.of_channel import MEANINGS, OfChannel
from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import OUT_OF_STEP
from fricmodels.term import Parameters, Signals


class Other(OfChannel):
    r"""A torque in proportion to a further channel, such as the acceleration of another joint.

    .. math:: \tau = c\,x

    With x an acceleration, c is the element of the inertia matrix between the two joints, as far as it is constant.

    Source: Elementary; M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control (2006), chapter 7.
    """

    name = "other"
    formula = "τ = c·x"
    signature = "in proportion to what was recorded beside this joint"
    needs_motion = "another joint that moves, and not in step with this one"
    separated_from = {"inertia-error": OUT_OF_STEP}
    c = Parameter("c", unit="N m", per="x", meaning="torque per unit of x")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c x."""
        return p.c * s[self.channel]

    @property
    def physics(self) -> str:
        """What the torque goes with, and what that most likely is."""
        meaning = MEANINGS.get(self.unit, "a cause outside of this joint's own motion")
        return f"it goes with {self.described()}: {meaning}"
