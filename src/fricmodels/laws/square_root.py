"""Viscous torque that grows with the square root of speed."""

from __future__ import annotations

from fricmodels.expressions import Expression, power, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals


class SquareRoot(Law):
    r"""Coulomb friction with a viscous torque that grows with the square root of speed.

    .. math:: \tau_F = [K_v|\omega|^{1/2} + K_c]\operatorname{sgn}\omega

    Source: Canudas de Wit et al. (1987), compared in Elhami and Brookfield (1997).
    """

    name = "square-root"
    formula = "τ_F = (K_v·|ω|^(1/2) + K_c)·sgn ω"
    symmetry = "odd"
    K_v = Parameter("K_v", unit="N m s^(1/2)/rad^(1/2)", lower=0.0, meaning="coefficient of the square root of speed")
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="Coulomb friction torque")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return (K_v |ω|^(1/2) + K_c) sgn ω."""
        return (p.K_v * power(s.velocity, 0.5) + p.K_c) * sign(s.velocity)
