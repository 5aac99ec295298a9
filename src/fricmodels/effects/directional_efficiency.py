"""Friction under load that differs between driving and being driven."""

from __future__ import annotations

from fricmodels.expressions import Expression, absolute, sign, where
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class DirectionalEfficiency(Effect):
    r"""A gear that loses another share of the load when it drives than when it is driven back.

    .. math:: \tau = [\mu_d\,(\tau_L\omega \ge 0) + \mu_b\,(\tau_L\omega < 0)]\,|\tau_L|\operatorname{sgn}\omega

    Source: Duclusaud et al. (2025), directional model M4.
    """

    name = "directional-efficiency"
    formula = "τ = (μ_d where τ_L·ω ≥ 0, μ_b where τ_L·ω < 0)·|τ_L|·sgn ω"
    signature = "in proportion to the load, with another slope when driven back"
    needs_motion = "a varying load, both signs of power"
    friction = True
    mu_d = Parameter("mu_d", lower=0.0, meaning="loss per load torque when the motor drives the load")
    mu_b = Parameter("mu_b", lower=0.0, meaning="loss per load torque when the load drives the motor")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return μ_d |τ_L| sgn ω when driving, μ_b |τ_L| sgn ω when driven."""
        driving = where(s.load_torque * s.velocity >= 0, 1, 0)
        return (p.mu_d * driving + p.mu_b * (1 - driving)) * absolute(s.load_torque) * sign(s.velocity)
