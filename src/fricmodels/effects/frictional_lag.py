"""Friction that follows the speed late."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array
from fricmodels.expressions import Expression, absolute, exp, maximum, sign
from fricmodels.parameter import Parameter, State
from fricmodels.results.experiments import SEVERAL_FREQUENCIES, SLOW_REVERSALS
from fricmodels.term import Effect, Parameters, Signals

if TYPE_CHECKING:
    from fricmodels.past import Past

_SHORTEST = 1e-3
"""Neither part of the lag is shorter than this share of it where rates are integrated: they would become infinite."""


class FrictionalLag(Effect):
    r"""Friction that falls with the speed and follows it late, as a lubricant film takes time to form.

    .. math::
        \tau = [F_s\,e^{-u/\omega_s} + K\,(u - |\omega|)]\operatorname{sgn}\omega, \qquad
        r T \dot u(t) = |\omega(t - (1 - r) T)| - u(t)

    T is the mean lag. A share r of it is a lag of the first order, the rest a delay: r = 0 is the pure delay that Hess
    and Soom measured, r = 1 the film that settles exponentially. All of the falling part lags: beside a law that has
    one by itself, the F_s of the law goes to zero. At constant speed it is the falling friction of a law, without δ.

    A recording holds the speed of a while ago, and u follows it exactly, as if it changed linearly between samples. To
    a filter or a simulation the delay D = (1 − r) T is Padé's of second order,

    .. math::
        \dot x = v, \quad \dot v = |\omega| - 6v/D - 12x/D^2, \quad
        |\omega(t - D)| \approx \max(|\omega| - 12v/D,\ 0).

    Source: Hess and Soom (1990), a pure delay; Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), section 2.1.
    The lag of the first order is the simplest film that takes time.
    """

    name = "frictional-lag"
    formula = "τ = [F_s·exp(−u/ω_s) + K·(u − |ω|)]·sgn ω;  u follows |ω|, (1 − r)·T late and with a lag of r·T"
    signature = "a loop in velocity: friction differs between speeding up and slowing down"
    needs_motion = "slow, accelerated motion"
    friction = True
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
        meaning="mean lag",
        own_time=True,
        scan=(0.0001, 0.0002, 0.0004, 0.0007, 0.0013, 0.0025, 0.005, 0.009, 0.017, 0.03),
    )
    r = Parameter(
        "r",
        initial=0.5,
        lower=0.0,
        upper=1.0,
        meaning="share of the lag that is of the first order, the rest being a delay",
        scan=(0.5,),
        doubtful_ends=(),
    )
    x = State("x", unit="rad s", meaning="state of the delay")
    v = State("v", unit="rad", meaning="state of the delay")
    u = State("u", unit="rad/s", meaning="speed that friction follows")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the friction at the speed that is followed, its viscous part less that at the present speed."""
        return (p.F_s * exp(-s.u / p.omega_s) + p.K * (s.u - absolute(s.velocity))) * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the rates of the delay's states and of the speed that is followed."""
        delay, constant = p.T * maximum(1 - p.r, _SHORTEST), p.T * maximum(p.r, _SHORTEST)
        speed = absolute(s.velocity)
        delayed = maximum(speed - 12 * s.v / delay, 0)
        return {"x": s.v, "v": speed - 6 * s.v / delay - 12 * s.x / delay**2, "u": (delayed - s.u) / constant}

    def first_states(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the states of a speed that has long been what it is."""
        delay, speed = p.T * maximum(1 - p.r, _SHORTEST), absolute(s.velocity)
        return {"x": speed * delay**2 / 12, "u": speed}

    def states_from_recording(self, past: Past, parameters: Mapping[str, float]) -> Mapping[str, Array]:
        """Return the states at which u follows the speed that was recorded."""
        delay = (1 - parameters["r"]) * parameters["T"]
        now, then = np.abs(past.now("velocity")), np.abs(past.ago("velocity", delay))
        followed = past.followed(then, parameters["r"] * parameters["T"])
        return {"x": np.zeros(len(now)), "v": delay / 12 * (now - then), "u": followed}
