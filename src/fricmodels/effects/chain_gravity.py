"""Gravity on a link that hangs on the angles of two joints."""

from __future__ import annotations

from fricmodels.effects.of_channel import OfChannel
from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import OUT_OF_STEP
from fricmodels.term import Parameters, Signals


class ChainGravity(OfChannel):
    r"""Gravity on a link behind two joints, this one at the angle q and another one at x.

    .. math:: \tau = a\cos q\cos x + b\cos q\sin x + c\sin q\cos x + d\sin q\sin x

    Where the axes are parallel the link's angle in space is q + x, or q − x if the joints count in opposite senses:
    :math:`m g r\cos(q + x + \varphi)` has d = −a and c = b. Of axes that are not parallel all four are free. With more
    joints before it, x is the sum of their angles.

    Source: M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control (2006), chapter 7 (the gravity of the
    second link of a planar elbow manipulator).
    """

    name = "chain-gravity"
    formula = "τ = a·cos q·cos x + b·cos q·sin x + c·sin q·cos x + d·sin q·sin x"
    signature = "once a turn in the sum of this angle and another one"
    needs_motion = "motion of this joint and of another one over a wide range"
    with_angle = True
    units = frozenset({"rad"})
    angular = True
    separated_from = {"gravity": OUT_OF_STEP, "other-gravity": "this joint moved over a wider range"}
    a = Parameter("a", unit="N m", meaning="torque in proportion to cos q cos x")
    b = Parameter("b", unit="N m", meaning="torque in proportion to cos q sin x")
    c = Parameter("c", unit="N m", meaning="torque in proportion to sin q cos x")
    d = Parameter("d", unit="N m", meaning="torque in proportion to sin q sin x")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return a cos q cos x + b cos q sin x + c sin q cos x + d sin q sin x."""
        q, x = s.position, s[self.channel]
        return cos(q) * (p.a * cos(x) + p.b * sin(x)) + sin(q) * (p.c * cos(x) + p.d * sin(x))

    @property
    def physics(self) -> str:
        """What the torque goes with."""
        return f"gravity by the angle of a link behind two joints, this one and {self.described()}, not friction"
