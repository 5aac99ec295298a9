"""Inertial coupling with the joint before, turned by this joint's angle."""

from __future__ import annotations

from fricmodels.effects.of_channel import OfChannel
from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.recording import RATE
from fricmodels.results.experiments import OUT_OF_STEP
from fricmodels.term import Parameters, Signals


class ProximalCoupling(OfChannel):
    r"""What a link feels of the joint that carries it, by the velocity x of that joint.

    .. math:: \tau = c\,\dot x + a\,(\cos q\,\dot x + \sin q\,x^2) + b\,(\sin q\,\dot x - \cos q\,x^2)

    For two links with parallel axes, q the angle between them, :math:`c = I_2` about this joint's axis, and
    :math:`a + ib = m_2 l_1 r_2\,e^{i q_0}`: the mass of this joint's link, the length of the link before, the distance
    of the mass from this axis, and the angle q₀ at which both links are in line. The squared speed is the centrifugal
    torque. It is what the equations of motion give for the second joint:
    :math:`(I_2 + h\cos q)\,\ddot q_1 + h \sin q\,\dot q_1^2` with :math:`h = m_2 l_1 r_2`.

    Source: M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control (2006), chapter 7 (planar elbow
    manipulator).
    """

    name = "proximal-coupling"
    formula = "τ = c·dx/dt + a·(cos q·dx/dt + sin q·x²) + b·(sin q·dx/dt − cos q·x²)"
    signature = "in proportion to the acceleration of another joint and its squared speed, turned by this joint's angle"
    needs_motion = "motion of the joint before it, and of this one over a wide range"
    separated_from = {"inertia-error": OUT_OF_STEP, "other-inertia": "this joint moved over a wider range"}
    with_angle = True
    units = frozenset({"rad/s"})
    angular = True
    c = Parameter("c", unit="N m", per="x", meaning="torque per unit of dx/dt")
    a = Parameter("a", unit="N m", per="x", meaning="the same, in proportion to cos q")
    b = Parameter("b", unit="N m", per="x", meaning="the same, in proportion to sin q")

    def signals_of(self, channel: str) -> tuple[str, ...]:
        """Return the rate of the channel, and itself."""
        return RATE + channel, channel

    def parameter_unit(self, unit: str) -> str:
        """Return the unit of the rate."""
        return "rad/s^2" if unit in self.units else ""

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c dx/dt + a (cos q dx/dt + sin q x²) + b (sin q dx/dt − cos q x²)."""
        rate, square = s[RATE + self.channel], s[self.channel] ** 2
        along, across = cos(s.position), sin(s.position)
        return p.c * rate + p.a * (along * rate + across * square) + p.b * (across * rate - along * square)

    @property
    def physics(self) -> str:
        """What the torque goes with, and what that most likely is."""
        return f"it goes with {self.described()} and this joint's angle: inertial coupling of two links, not friction"
