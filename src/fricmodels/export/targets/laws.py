"""The friction laws that simulators have, as laws of this package: one engine fits them all."""

from __future__ import annotations

from fricmodels.expressions import Expression, absolute, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals


class Viscous(Law):
    r"""Friction in proportion to velocity, and nothing else.

    .. math:: \tau_F = K_v\,\omega
    """

    name = "viscous"
    formula = "τ_F = K_v·ω"
    symmetry = "odd"
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return K_v ω."""
        return p.K_v * s.velocity


class PolynomialDamping(Law):
    r"""Dry friction, and damping that is a polynomial in speed.

    .. math:: \tau_F = K_c \operatorname{sgn}\omega + d_1\,\omega + d_2\,|\omega|\,\omega + d_3\,\omega^3

    Source: MuJoCo 4.0, ``joint/damping`` and ``joint/frictionloss``.
    """

    name = "polynomial-damping"
    formula = "τ_F = K_c·sgn ω + d_1·ω + d_2·|ω|·ω + d_3·ω³"
    symmetry = "odd"
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="dry friction torque")
    d_1 = Parameter("d_1", unit="N m s/rad", lower=0.0, meaning="linear damping")
    d_2 = Parameter("d_2", unit="N m s^2/rad^2", lower=0.0, meaning="quadratic damping")
    d_3 = Parameter("d_3", unit="N m s^3/rad^3", lower=0.0, meaning="cubic damping")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return K_c sgn ω + d_1 ω + d_2 |ω| ω + d_3 ω³."""
        v = s.velocity
        return p.K_c * sign(v) + (p.d_1 + p.d_2 * absolute(v) + p.d_3 * v**2) * v
