"""M4: load-dependent friction with the Stribeck effect."""

from __future__ import annotations

from fricmodels import Parameter
from fricmodels.expressions import Expression
from fricmodels.term import Parameters, Signals
from fricmodels_bam.m1 import transmitted
from fricmodels_bam.m2 import Stribeck


class StribeckLoadDependent(Stribeck):
    r"""Dry friction that grows with the load, more so near rest.

    .. math:: \tau_{dry} = K_c + K_l\,|\tau_m + \tau_L| + S\,(K_{cs} + K_{ls}\,|\tau_m + \tau_L|)

    Source: Duclusaud et al. (2025), model M4, where τ_e = −τ_L.
    """

    name = "bam-m4"
    formula = "τ_F = K_v·ω + (K_c + K_l·|τ_m + τ_L| + S·(K_cs + K_ls·|τ_m + τ_L|))·sgn ω, S = exp(−|ω/ω_s|^α)"
    K_l = Parameter("K_l", lower=0.0, meaning="friction torque per transmitted torque")
    K_ls = Parameter("K_ls", lower=0.0, meaning="the same, extra at rest")

    def sliding(self, s: Signals, p: Parameters) -> Expression:
        """Return the Coulomb torque and the load's share."""
        return p.K_c + p.K_l * transmitted(s)

    def sticking(self, s: Signals, p: Parameters) -> Expression:
        """Return what both have more of at rest."""
        return p.K_cs + p.K_ls * transmitted(s)
