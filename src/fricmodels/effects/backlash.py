"""Play between motor and load."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, maximum, minimum, sign, where
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Parameters, Signals


class Backlash(Effect):
    r"""Play: after a reversal the motor crosses a gap of width w without the load, which coasts and is then struck.

    .. math::
        \tau = -J_l\,\dot v - F\,(|x| < w/2)\operatorname{sgn}\omega, \qquad \dot x = v, \qquad
        \dot v = \dot\omega - [\omega_c^2\,d(x) + \omega_c v]\,(|x| \ge w/2) + \frac{\omega - v}{T_l}\,(|x| < w/2)

    with the twist x between motor and load, d(x) its part beyond the gap, and a stiff, well damped contact (damping
    ratio 1/2). Within the gap the load, of speed ω − v, comes to rest by itself within about T_l. The drive's inertia
    stays the whole one, motor and load.

    Source: Nordin and Gutman (2002), the dead-zone model.
    """

    name = "backlash"
    formula = "τ = −J_l·dv/dt − F·(|x| < w/2)·sgn ω;  dx/dt = v;  dv/dt = dω/dt − contact + coasting"
    signature = "a pulse after each reversal, of fixed width in position, and a shock at its end"
    needs_motion = "reversals"
    J_l = Parameter("J_l", unit="kg m^2", lower=0.0, meaning="inertia of the load behind the gap")
    F = Parameter("F", unit="N m", meaning="friction torque of the load, missing within the gap")
    w = Parameter(
        "w",
        unit="rad",
        initial=1e-3,
        lower=1e-12,
        meaning="width of the gap",
        scan=(0.00003, 0.0001, 0.0003, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1),
    )
    omega_c = Parameter(
        "omega_c",
        unit="1/s",
        initial=300.0,
        lower=1e-9,
        meaning="natural angular frequency of the load on the contact",
        scan=(500.0, 2000.0, 8000.0),
    )
    T_l = Parameter(
        "T_l",
        unit="s",
        initial=0.1,
        lower=1e-9,
        meaning="time in which the load comes to rest within the gap",
        scan=(0.00003, 0.003),
    )
    x = State("x", unit="rad", meaning="twist between motor and load")
    v = State("v", unit="rad/s", meaning="rate of twist")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque through the contact less what a rigid load would take."""
        gap_open = where(absolute(s.x) < p.w / 2, 1, 0)
        return p.J_l * (_contact(s, p) - s.acceleration) - p.F * gap_open * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return the rates of twist."""
        coasting = where(absolute(s.x) < p.w / 2, (s.velocity - s.v) / p.T_l, 0)
        return {"x": s.v, "v": s.acceleration - _contact(s, p) + coasting}


def _contact(s: Signals, p: Parameters) -> Expression:
    """Return the torque of the contact per inertia of the load."""
    beyond = maximum(s.x - p.w / 2, 0) + minimum(s.x + p.w / 2, 0)
    touching = where(absolute(s.x) >= p.w / 2, 1, 0)
    return touching * (p.omega_c**2 * beyond + p.omega_c * s.v)
