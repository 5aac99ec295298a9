"""Friction that changes slowly with time."""

from __future__ import annotations

from fricmodels.expressions import Expression, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class Drift(Effect):
    r"""Viscous and Coulomb friction that change slowly with time: run-in, warming without a thermometer.

    .. math:: \tau = a\,\omega t + b\,t \operatorname{sgn}\omega

    Source: Elementary; the first order of any slow change.
    """

    name = "drift"
    formula = "τ = a·ω·t + b·t·sgn ω"
    signature = "along the motion, growing or falling with time"
    needs_motion = "a long record"
    symmetry = "odd"
    depends_on_time = True
    a = Parameter("a", unit="N m/rad", meaning="change of the viscous coefficient per second")
    b = Parameter("b", unit="N m/s", meaning="change of the Coulomb torque per second")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return a ω t + b t sgn ω."""
        return (p.a * s.velocity + p.b * sign(s.velocity)) * s.time
