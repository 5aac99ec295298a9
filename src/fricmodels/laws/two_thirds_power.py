"""Viscous torque of lubricated rolling bearings, growing with speed to the power 2/3."""

from __future__ import annotations

from fricmodels.expressions import Expression, power, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals


class TwoThirdsPower(Law):
    r"""Coulomb friction with a viscous torque that grows with speed to the power 2/3.

    .. math:: \tau_F = [K_v|\omega|^{2/3} + K_c]\operatorname{sgn}\omega

    Source: SKF's bearing friction, compared in Elhami and Brookfield (1997).
    """

    name = "two-thirds-power"
    formula = "τ_F = (K_v·|ω|^(2/3) + K_c)·sgn ω"
    symmetry = "odd"
    K_v = Parameter("K_v", unit="N m s^(2/3)/rad^(2/3)", lower=0.0, meaning="coefficient of speed to the power 2/3")
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="Coulomb friction torque")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return (K_v |ω|^(2/3) + K_c) sgn ω."""
        return (p.K_v * power(s.velocity, 2 / 3) + p.K_c) * sign(s.velocity)
