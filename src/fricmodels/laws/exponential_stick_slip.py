"""Friction that falls exponentially from a stick torque to a slip torque."""

from __future__ import annotations

from fricmodels.expressions import Expression, absolute, exp, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals


class ExponentialStickSlip(Law):
    r"""Stick torque that falls exponentially to the slip torque, with viscous friction.

    .. math:: \tau_F = [K_v|\omega| + C + (K_c - C)\,e^{-B|\omega|}]\operatorname{sgn}\omega

    Source: Elhami and Brookfield (1997), eq. 4 with both directions equal.
    """

    name = "exponential-stick-slip"
    formula = "τ_F = [K_v·|ω| + C + (K_c − C)·exp(−B·|ω|)]·sgn ω"
    symmetry = "odd"
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    K_c = Parameter("K_c", unit="N m", lower=0.0, at_least="C", meaning="Coulomb friction torque at stick")
    C = Parameter("C", unit="N m", lower=0.0, meaning="Coulomb friction torque at slip")
    B = Parameter("B", unit="s/rad", lower=0.0, meaning="stick-to-slip rate", scan=(3.0, 10.0, 30.0, 100.0, 300.0))

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque of eq. 4 with equal coefficients."""
        fall = exp(-p.B * absolute(s.velocity))
        return p.K_v * s.velocity + (p.C + (p.K_c - p.C) * fall) * sign(s.velocity)
