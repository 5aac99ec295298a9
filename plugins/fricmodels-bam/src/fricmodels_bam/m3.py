"""M3: Coulomb and viscous friction that grows with the load of the gearbox."""

from __future__ import annotations

from fricmodels import Parameter
from fricmodels.expressions import Expression
from fricmodels.term import Parameters, Signals
from fricmodels_bam.m1 import CoulombViscous, transmitted


class LoadDependent(CoulombViscous):
    r"""Dry friction in proportion to the torque that the gearbox transmits.

    .. math:: \tau_{dry} = K_c + K_l\,|\tau_m + \tau_L|

    Source: Duclusaud et al. (2025), model M3, where τ_e = −τ_L.
    """

    name = "bam-m3"
    formula = "τ_F = K_v·ω + (K_c + K_l·|τ_m + τ_L|)·sgn ω"
    K_l = Parameter("K_l", lower=0.0, meaning="friction torque per transmitted torque")

    def dry(self, s: Signals, p: Parameters) -> Expression:
        """Return the Coulomb torque and the load's share."""
        return p.K_c + p.K_l * transmitted(s)
