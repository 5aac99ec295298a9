"""Coulomb and viscous friction that differ between the directions."""

from __future__ import annotations

from fricmodels.expressions import Expression, negative, positive
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals


class AsymmetricCoulombViscous(Law):
    r"""Coulomb and viscous friction, another pair of coefficients in each direction.

    .. math:: \tau_F = [K_{v1}|\omega| + K_{c1}]\,\mathrm{sgn}_1\omega + [K_{v2}|\omega| + K_{c2}]\,\mathrm{sgn}_2\omega

    Source: Elhami and Brookfield (1997), eq. 4 without its exponential part.
    """

    name = "asymmetric-coulomb-viscous"
    formula = "τ_F = (K_v1·|ω| + K_c1)·sgn₁ω + (K_v2·|ω| + K_c2)·sgn₂ω"
    K_v1 = Parameter("K_v1", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient, positive rotation")
    K_v2 = Parameter("K_v2", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient, negative rotation")
    K_c1 = Parameter("K_c1", unit="N m", lower=0.0, meaning="Coulomb friction torque, positive rotation")
    K_c2 = Parameter("K_c2", unit="N m", lower=0.0, meaning="Coulomb friction torque, negative rotation")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return (K_v1 ω + K_c1) where ω ≥ 0, (K_v2 ω − K_c2) where ω < 0."""
        forward, backward = positive(s.velocity), negative(s.velocity)
        return (p.K_v1 * s.velocity + p.K_c1) * forward + (p.K_v2 * s.velocity - p.K_c2) * backward
