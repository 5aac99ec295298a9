"""The paper's full law: exponential stick to slip, another in each direction."""

from __future__ import annotations

from fricmodels.expressions import Expression, absolute, exp, negative, positive
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals

_SCAN = (3.0, 10.0, 30.0, 100.0, 300.0)


class AsymmetricExponentialStickSlip(Law):
    r"""Stick torque that falls exponentially to the slip torque, different in each direction.

    .. math::
        \tau_F = [K_{v1}|\omega| + C_1 + (K_{c1}-C_1)e^{-B_1|\omega|}]\,\mathrm{sgn}_1\omega
               + [K_{v2}|\omega| + C_2 + (K_{c2}-C_2)e^{-B_2|\omega|}]\,\mathrm{sgn}_2\omega

    Source: Elhami and Brookfield (1997), eq. 4.
    """

    name = "asymmetric-exponential-stick-slip"
    formula = "τ_F = [K_v1·|ω| + C_1 + (K_c1 − C_1)·exp(−B_1·|ω|)]·sgn₁ω + [… 2 …]·sgn₂ω"
    K_v1 = Parameter("K_v1", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient, positive rotation")
    K_v2 = Parameter("K_v2", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient, negative rotation")
    K_c1 = Parameter(
        "K_c1", unit="N m", lower=0.0, at_least="C_1", meaning="Coulomb torque at stick, positive rotation"
    )
    K_c2 = Parameter(
        "K_c2", unit="N m", lower=0.0, at_least="C_2", meaning="Coulomb torque at stick, negative rotation"
    )
    C_1 = Parameter("C_1", unit="N m", lower=0.0, meaning="Coulomb torque at slip, positive rotation")
    C_2 = Parameter("C_2", unit="N m", lower=0.0, meaning="Coulomb torque at slip, negative rotation")
    B_1 = Parameter("B_1", unit="s/rad", lower=0.0, meaning="stick-to-slip rate, positive rotation", scan=_SCAN)
    B_2 = Parameter("B_2", unit="s/rad", lower=0.0, meaning="stick-to-slip rate, negative rotation", scan=_SCAN)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque of eq. 4."""
        speed = absolute(s.velocity)
        forward = p.K_v1 * s.velocity + p.C_1 + (p.K_c1 - p.C_1) * exp(-p.B_1 * speed)
        backward = p.K_v2 * s.velocity - p.C_2 - (p.K_c2 - p.C_2) * exp(-p.B_2 * speed)
        return forward * positive(s.velocity) + backward * negative(s.velocity)
