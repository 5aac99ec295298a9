"""Friction that follows velocity with a delay."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, exp, sign
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Parameters, Signals


class FrictionalLag(Effect):
    r"""Friction that follows the speed with a delay, as a lubricant film takes time to form (frictional memory).

    .. math::
        \tau = [F_s\,(e^{-z/\omega_s} - e^{-|\omega|/\omega_s}) + K\,(z - |\omega|)]\operatorname{sgn}\omega,
        \qquad \dot z = (|\omega| - z)/T

    It takes the falling and the viscous part of a law's friction away at the present speed and puts them back at the
    speed z that the film has followed; at constant speed it is zero.

    Source: Hess and Soom (1990); Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), section 2.1.
    """

    name = "frictional-lag"
    formula = "τ = [F_s·(exp(−z/ω_s) − exp(−|ω|/ω_s)) + K·(z − |ω|)]·sgn ω;  dz/dt = (|ω| − z)/T"
    signature = "a loop in velocity: friction differs between speeding up and slowing down"
    needs_motion = "slow, accelerated motion"
    F_s = Parameter("F_s", unit="N m", lower=0.0, meaning="falling part of the friction that lags")
    K = Parameter(
        "K", unit="N m s/rad", lower=0.0, part_of_law=True, meaning="viscous coefficient of the friction that lags"
    )
    omega_s = Parameter(
        "omega_s",
        unit="rad/s",
        initial=1.0,
        lower=1e-9,
        meaning="speed over which the lagging friction falls",
        scan=(0.01, 0.03, 0.1, 0.3),
    )
    T = Parameter("T", unit="s", initial=1e-3, lower=1e-9, meaning="delay", scan=(0.0001, 0.0003, 0.001, 0.003, 0.01))
    z = State("z", unit="rad/s", meaning="speed that the film has followed")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the friction at the followed speed less that at the present speed."""
        speed = absolute(s.velocity)
        falling = exp(-s.z / p.omega_s) - exp(-speed / p.omega_s)
        return (p.F_s * falling + p.K * (s.z - speed)) * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dz/dt = (|ω| − z)/T."""
        return {"z": (absolute(s.velocity) - s.z) / p.T}
