"""Friction that follows velocity with a delay."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, exp, sign
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Parameters, Signals


class FrictionalLag(Effect):
    r"""The Stribeck friction of a film that takes time to form: it follows the speed with a delay (frictional memory).

    .. math:: \tau = F_s\,e^{-z/\omega_s}\operatorname{sgn}\omega, \qquad \dot z = (|\omega| - z)/T

    Without delay, T = 0, it is the Stribeck effect with exponent 1.

    Source: Hess and Soom (1990); Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), section 2.1.
    """

    name = "frictional-lag"
    formula = "τ = F_s·exp(−z/ω_s)·sgn ω;  dz/dt = (|ω| − z)/T"
    signature = "a loop in velocity near standstill: more friction when speeding up than when slowing down"
    needs_motion = "slow, accelerated motion"
    F_s = Parameter("F_s", unit="N m", lower=0.0, meaning="extra friction torque at vanishing speed")
    omega_s = Parameter(
        "omega_s", unit="rad/s", initial=1.0, lower=1e-9, meaning="Stribeck speed", scan=(0.03, 0.1, 0.2, 0.4)
    )
    T = Parameter("T", unit="s", initial=1e-3, lower=1e-9, meaning="delay", scan=(0.0003, 0.001, 0.003, 0.01))
    z = State("z", unit="rad/s", meaning="speed that the film has followed")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F_s exp(−z/ω_s) sgn ω."""
        return p.F_s * exp(-s.z / p.omega_s) * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dz/dt = (|ω| − z)/T."""
        return {"z": (absolute(s.velocity) - s.z) / p.T}
