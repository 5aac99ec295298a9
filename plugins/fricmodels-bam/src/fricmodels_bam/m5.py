"""M5: friction that depends on the side from which the gearbox is loaded."""

from __future__ import annotations

from fricmodels import Parameter
from fricmodels.expressions import Expression, absolute
from fricmodels.term import Parameters, Signals
from fricmodels_bam.m2 import Stribeck


class Directional(Stribeck):
    r"""Motor torque and load torque cost differently: a gearbox that drives well may be driven back badly.

    .. math::
        \tau_{dry} = K_c + |K_m\tau_m + K_e\tau_L| + S\,(K_{cs} + |K_{ms}\tau_m + K_{es}\tau_L|)

    Source: Duclusaud et al. (2025), model M5, where τ_e = −τ_L.
    """

    name = "bam-m5"
    formula = "τ_F = K_v·ω + (K_c + |K_m·τ_m + K_e·τ_L| + S·(K_cs + |K_ms·τ_m + K_es·τ_L|))·sgn ω, S = exp(−|ω/ω_s|^α)"
    K_m = Parameter("K_m", lower=0.0, meaning="friction torque per motor torque", scan=(0.05, 0.3))
    K_e = Parameter("K_e", lower=0.0, meaning="friction torque per load torque", scan=(0.05, 0.3))
    K_ms = Parameter("K_ms", lower=0.0, meaning="that of the motor torque, extra at rest", scan=(0.1,))
    K_es = Parameter("K_es", lower=0.0, meaning="that of the load torque, extra at rest", scan=(0.1,))

    def sliding(self, s: Signals, p: Parameters) -> Expression:
        """Return the Coulomb torque and the shares of both sides."""
        return p.K_c + absolute(p.K_m * s.motor_torque + p.K_e * s.load_torque)

    def sticking(self, s: Signals, p: Parameters) -> Expression:
        """Return what they have more of at rest."""
        return p.K_cs + absolute(p.K_ms * s.motor_torque + p.K_es * s.load_torque)
