"""Gravity by the angle of a further channel."""

from __future__ import annotations

from fricmodels.effects.of_channel import OfChannel
from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import OUT_OF_STEP
from fricmodels.term import Parameters, Signals


class OtherGravity(OfChannel):
    r"""Gravity on a link whose place goes with a further channel x, an angle.

    .. math:: \tau = a\cos x + b\sin x

    x is the angle of another joint, or the sum of angles up to the link.

    Source: Elementary; m g r cos(x − x_0).
    """

    name = "other-gravity"
    formula = "τ = a·cos x + b·sin x"
    signature = "once a turn in the other angle, whatever this joint does"
    needs_motion = "another joint that moves over a wide range"
    units = frozenset({"rad"})
    separated_from = {"gravity": OUT_OF_STEP, "other": "the other joint moved over a wider range"}
    a = Parameter("a", unit="N m", meaning="torque in proportion to cos x")
    b = Parameter("b", unit="N m", meaning="torque in proportion to sin x")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return a cos x + b sin x."""
        x = s[self.channel]
        return p.a * cos(x) + p.b * sin(x)

    @property
    def physics(self) -> str:
        """What the torque goes with."""
        return f"gravity by {self.described()}, not friction"
