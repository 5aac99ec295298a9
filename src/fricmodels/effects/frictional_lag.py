"""Friction that follows velocity with a delay."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array
from fricmodels.effects.experiments import SEVERAL_FREQUENCIES, SLOW_REVERSALS
from fricmodels.expressions import Expression, absolute, exp, maximum, sign
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Parameters, Signals

if TYPE_CHECKING:
    from fricmodels.past import Past


class FrictionalLag(Effect):
    r"""Friction that follows the speed with a delay, as a lubricant film takes time to form (frictional memory).

    .. math::
        \tau = [F_s\,(e^{-u/\omega_s} - e^{-|\omega|/\omega_s}) + K\,(u - |\omega|)]\operatorname{sgn}\omega,
        \qquad u(t) \approx |\omega(t - T)|

    It takes the falling and the viscous part of a law's friction away at the present speed and puts them back at the
    speed u of a time T ago; at constant speed it is zero. A recording holds that speed. To a filter or a simulation the
    delay is Padé's of second order,

    .. math:: \dot x = v, \quad \dot v = |\omega| - 6v/T - 12x/T^2, \quad u = \max(|\omega| - 12v/T,\ 0).

    Source: Hess and Soom (1990), a pure time lag; Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), section 2.1.
    """

    name = "frictional-lag"
    formula = "τ = [F_s·(exp(−u/ω_s) − exp(−|ω|/ω_s)) + K·(u − |ω|)]·sgn ω;  u(t) = |ω(t − T)|"
    signature = "a loop in velocity: friction differs between speeding up and slowing down"
    needs_motion = "slow, accelerated motion"
    separated_from = {
        "inertia-error": SEVERAL_FREQUENCIES,
        **dict.fromkeys(("stribeck", "rising-stiction"), SLOW_REVERSALS),
    }
    F_s = Parameter("F_s", unit="N m", lower=0.0, part_of_drive=True, meaning="falling part of the friction that lags")
    K = Parameter(
        "K", unit="N m s/rad", lower=0.0, part_of_drive=True, meaning="viscous coefficient of the friction that lags"
    )
    omega_s = Parameter(
        "omega_s",
        unit="rad/s",
        initial=1.0,
        lower=1e-9,
        meaning="speed over which the lagging friction falls",
        scan=(0.01, 0.03, 0.1, 0.3),
        doubtful_ends=(),  # at either end only the viscous part lags
    )
    T = Parameter(
        "T",
        unit="s",
        initial=1e-3,
        lower=1e-9,
        meaning="delay",
        own_time=True,
        scan=(0.0001, 0.0002, 0.0004, 0.0007, 0.0013, 0.0025, 0.005, 0.009, 0.017, 0.03),
    )
    x = State("x", unit="rad s", meaning="state of the delay")
    v = State("v", unit="rad", meaning="state of the delay")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the friction at the speed of a time T ago less that at the present speed."""
        speed = absolute(s.velocity)
        followed = maximum(speed - 12 * s.v / p.T, 0)
        falling = exp(-followed / p.omega_s) - exp(-speed / p.omega_s)
        return (p.F_s * falling + p.K * (followed - speed)) * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the rates of the delay's states."""
        return {"x": s.v, "v": absolute(s.velocity) - 6 * s.v / p.T - 12 * s.x / p.T**2}

    def states_from_recording(self, past: Past, parameters: Mapping[str, float]) -> Mapping[str, Array]:
        """Return the states at which u is the speed that was recorded a time T ago."""
        duration = parameters["T"]
        now, then = np.abs(past.now("velocity")), np.abs(past.ago("velocity", duration))
        return {"x": np.zeros(len(now)), "v": duration / 12 * (now - then)}
