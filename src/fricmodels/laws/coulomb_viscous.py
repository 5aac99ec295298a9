"""Symmetric Coulomb and viscous friction."""

from __future__ import annotations

from fricmodels.expressions import Expression, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals


class CoulombViscous(Law):
    r"""Coulomb and viscous friction, the same in both directions.

    .. math:: \tau_F = K_v \omega + K_c \operatorname{sgn} \omega

    Source: Elhami and Brookfield (1997), the first of the laws compared there.
    """

    name = "coulomb-viscous"
    formula = "τ_F = K_v·ω + K_c·sgn ω"
    symmetry = "odd"
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="Coulomb friction torque")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return K_v ω + K_c sgn ω."""
        return p.K_v * s.velocity + p.K_c * sign(s.velocity)
