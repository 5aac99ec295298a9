"""Friction that falls with speed just above standstill."""

from __future__ import annotations

from fricmodels.expressions import Expression, exp, power, sign
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import SLOW_REVERSALS, WIDER_SPEED
from fricmodels.term import Effect, Parameters, Signals


class Stribeck(Effect):
    r"""Extra friction near standstill that falls with speed (boundary to mixed lubrication).

    .. math:: \tau = F_s\,e^{-(|\omega|/\omega_s)^\delta}\operatorname{sgn}\omega

    Source: Stribeck (1902); exponent form of Bo and Pavelescu (1982).
    """

    name = "stribeck"
    formula = "τ = F_s·exp(−(|ω|/ω_s)^δ)·sgn ω"
    signature = "along the motion and near zero speed only"
    needs_motion = "slow sliding"
    friction = True
    separated_from = {
        "nonlinear-viscous": WIDER_SPEED,
        "rising-stiction": SLOW_REVERSALS,
    }
    dissipative = True
    symmetry = "odd"
    F_s = Parameter("F_s", unit="N m", lower=0.0, meaning="extra friction torque at vanishing speed")
    omega_s = Parameter(
        "omega_s",
        unit="rad/s",
        initial=1.0,
        lower=1e-9,
        meaning="Stribeck speed",
        scan=(0.01, 0.03, 0.1, 0.2, 0.4),
    )
    delta = Parameter("delta", initial=1.0, lower=0.5, upper=2.5, meaning="Stribeck exponent", scan=(1.0, 2.0))

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F_s exp(−(|ω|/ω_s)^δ) sgn ω."""
        return p.F_s * exp(-power(s.velocity, p.delta, p.omega_s)) * sign(s.velocity)
