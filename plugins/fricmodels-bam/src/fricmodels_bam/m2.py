"""M2: Coulomb and viscous friction with the Stribeck effect."""

from __future__ import annotations

from fricmodels import Parameter
from fricmodels.expressions import Expression, exp, power
from fricmodels.term import Parameters, Signals
from fricmodels_bam.m1 import CoulombViscous


class Stribeck(CoulombViscous):
    r"""More dry friction near rest, which falls as the motion begins.

    .. math:: \tau_{dry} = K_c + S\,K_{cs}, \qquad S = e^{-|\omega/\omega_s|^\alpha}

    Source: Duclusaud et al. (2025), model M2.
    """

    name = "bam-m2"
    formula = "τ_F = K_v·ω + (K_c + S·K_cs)·sgn ω, S = exp(−|ω/ω_s|^α)"
    K_cs = Parameter("K_cs", unit="N m", lower=0.0, meaning="extra friction torque at rest")
    omega_s = Parameter(
        "omega_s", unit="rad/s", initial=1.0, lower=1e-9, meaning="Stribeck speed", scan=(0.03, 0.1, 0.3)
    )
    alpha = Parameter("alpha", initial=1.35, lower=1.0, upper=10.0, meaning="Stribeck exponent", scan=(1.0, 2.0))

    def dry(self, s: Signals, p: Parameters) -> Expression:
        """Return the dry friction while sliding and what is added near rest."""
        return self.sliding(s, p) + near_rest(s, p) * self.sticking(s, p)

    def sliding(self, s: Signals, p: Parameters) -> Expression:
        """Return the dry friction at speed [N m]."""
        return p.K_c

    def sticking(self, s: Signals, p: Parameters) -> Expression:
        """Return what is added to it at rest [N m]."""
        return p.K_cs


def near_rest(s: Signals, p: Parameters) -> Expression:
    """Return the Stribeck factor S: 1 at rest, 0 at speed."""
    return exp(-power(s.velocity, p.alpha, p.omega_s))
