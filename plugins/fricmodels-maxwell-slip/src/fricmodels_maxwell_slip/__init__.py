"""The generalised Maxwell-slip law of Lampaert, Al-Bender and Swevers (2003, 2005), as a plugin of fricmodels."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels import Law, Parameter, hookimpl
from fricmodels.expressions import Expression, absolute, exp, maximum, sign, where
from fricmodels.parameter import State
from fricmodels.term import Parameters, Signals

__all__ = ["SPREAD", "GeneralisedMaxwellSlip", "fricmodels_laws"]

SPREAD = (0.125, 0.25, 0.5, 1.0)
"""Displacement at which each element breaks away from rest, over that of the last one."""

_TINY = 1e-100
"""Keeps nothing over nothing at nothing."""


class GeneralisedMaxwellSlip(Law):
    r"""Four elastic elements side by side, each of which either sticks or slips.

    Element i carries the torque :math:`F_i \varphi_i`. While it sticks it is a spring; it slips once its torque reaches
    the speed's friction curve h, and from then on follows that curve with a delay, until the motion stops or turns:

    .. math::
        \dot\varphi_i = \begin{cases}
            \omega\,r / (d_i x_s) & \text{sticking} \\
            \operatorname{sgn}\omega\,(1 - |\varphi_i| / h)/T & \text{slipping}
        \end{cases} \qquad
        h(\omega) = 1 + (r - 1)\,e^{-(\omega/v_s)^2}, \qquad
        \tau_F = \sum_i F_i \varphi_i + K_v \omega

    In the source's terms: :math:`s(v) = F_c h`, :math:`F_c = \sum F_i`, :math:`\alpha_i = F_i/F_c`, stiffness
    :math:`k_i = F_i r/(d_i x_s)`, and the attraction parameter :math:`C = F_c/T`. The elements break away from rest at
    the fixed spread of displacements :data:`SPREAD` times x_s, so that their torques enter linearly and the curve of
    presliding is a polygon through these points. Which elements slip is remembered, so the law has hysteresis with
    nonlocal memory in position and a lag in speed; springs give back what they stored, so it can push for a moment.

    Source: V. Lampaert, F. Al-Bender, J. Swevers, "A generalized Maxwell-slip friction model appropriate for control
    purposes", Proc. IEEE Int. Conf. Physics and Control, 2003, pp. 1170–1177; F. Al-Bender, V. Lampaert, J. Swevers,
    "The generalized Maxwell-slip model: a novel model for friction simulation and compensation", IEEE Transactions on
    Automatic Control 50(11), 2005, pp. 1883–1887.
    """

    name = "maxwell-slip"
    formula = (
        "τ_F = Σ F_i·φ_i + K_v·ω;  sticking: dφ_i/dt = ω·r/(d_i·x_s), slipping: dφ_i/dt = sgn ω·(1 − |φ_i|/h)/T;  "
        "h = 1 + (r − 1)·exp(−(ω/v_s)²)"
    )
    dissipative = False
    F_1 = Parameter("F_1", unit="N m", lower=0.0, meaning="Coulomb torque of the element that breaks away at x_s/8")
    F_2 = Parameter("F_2", unit="N m", lower=0.0, meaning="Coulomb torque of the element that breaks away at x_s/4")
    F_3 = Parameter("F_3", unit="N m", lower=0.0, meaning="Coulomb torque of the element that breaks away at x_s/2")
    F_4 = Parameter("F_4", unit="N m", lower=0.0, meaning="Coulomb torque of the element that breaks away at x_s")
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    x_s = Parameter(
        "x_s",
        unit="rad",
        initial=1e-2,
        lower=1e-12,
        meaning="displacement from rest at which everything slips",
        scan=(0.001, 0.005, 0.02, 0.1),
    )
    r = Parameter("r", initial=1.2, lower=1.0, meaning="stick torque over Coulomb torque", scan=(1.2, 2.0))
    v_s = Parameter(
        "v_s",
        unit="rad/s",
        initial=0.1,
        lower=1e-9,
        meaning="speed at which friction falls (Stribeck)",
        scan=(0.02, 0.1, 0.3),
    )
    T = Parameter(
        "T",
        unit="s",
        initial=1e-2,
        lower=1e-9,
        meaning="time in which friction of slipping approaches its curve, F_c/C",
        own_time=True,
        scan=(0.0003, 0.003),
    )
    phi_1 = State("phi_1", meaning="torque of element 1 over its Coulomb torque")
    phi_2 = State("phi_2", meaning="torque of element 2 over its Coulomb torque")
    phi_3 = State("phi_3", meaning="torque of element 3 over its Coulomb torque")
    phi_4 = State("phi_4", meaning="torque of element 4 over its Coulomb torque")
    slips_1 = State("slips_1", meaning="whether element 1 slips, 0 or 1")
    slips_2 = State("slips_2", meaning="whether element 2 slips, 0 or 1")
    slips_3 = State("slips_3", meaning="whether element 3 slips, 0 or 1")
    slips_4 = State("slips_4", meaning="whether element 4 slips, 0 or 1")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return Σ F_i φ_i + K_v ω."""
        return p.F_1 * s.phi_1 + p.F_2 * s.phi_2 + p.F_3 * s.phi_3 + p.F_4 * s.phi_4 + p.K_v * s.velocity

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dφ_i/dt; an element begins or ceases to slip in no time, which only :meth:`discrete_step` can say."""
        direction, level = sign(s.velocity), _curve(absolute(s.velocity), p)
        changes: dict[str, Expression] = {}
        for i, (phi, slips) in enumerate(_elements(s), start=1):
            along = direction * phi
            slipping = (along > 0) * maximum(along >= level, slips > 0.5)
            slip = direction * (1 - along / level) / p.T
            changes[f"phi_{i}"] = where(slipping, slip, s.velocity * p.r / (SPREAD[i - 1] * p.x_s))
            changes[f"slips_{i}"] = 0 * phi
        return changes

    def discrete_step(self, s: Signals, later: Signals, h: Expression, p: Parameters) -> Mapping[str, Expression]:
        """Return the states after a step in which the velocity changes linearly; where it turns, in two parts."""
        first, last = s.velocity, later.velocity
        turns = first * last < 0
        share = where(turns, absolute(first) / maximum(absolute(first) + absolute(last), _TINY), 1)
        stop = where(turns, 0, last)
        following: dict[str, Expression] = {}
        for i, (phi, slips) in enumerate(_elements(s), start=1):
            stiffness = p.r / (SPREAD[i - 1] * p.x_s)
            there, slipped = _slide(phi, slips, first, stop, share * h, stiffness, p)
            following[f"phi_{i}"], slipped_back = _slide(there, 0, 0, last, (1 - share) * h, stiffness, p)
            following[f"slips_{i}"] = where(turns, slipped_back, slipped)
        return following


def _elements(s: Signals) -> list[tuple[Expression, Expression]]:
    return [(s.phi_1, s.slips_1), (s.phi_2, s.slips_2), (s.phi_3, s.slips_3), (s.phi_4, s.slips_4)]


def _curve(speed: Expression, p: Parameters) -> Expression:
    """Return h, the friction of steady slipping over the Coulomb torque."""
    return 1 + (p.r - 1) * exp(-((speed / p.v_s) ** 2))


def _slide(
    phi: Expression,
    slips: Expression,
    first: Expression,
    last: Expression,
    duration: Expression,
    stiffness: Expression,
    p: Parameters,
) -> tuple[Expression, Expression]:
    """Move one element in one direction, the velocity going linearly from ``first`` to ``last``.

    It sticks up to the point at which its torque meets the curve, and slips for the rest of the time. In no time
    nothing changes.

    Returns:
        The element's state, and 1 if it slips at the end, else 0.
    """
    direction = sign(first + last)
    begin, end = absolute(first), absolute(last)
    along = direction * phi
    slipping = (slips > 0.5) * (along > 0) * (begin > 0)
    reached = along + stiffness * duration * (begin + end) / 2
    curve = (_curve(begin, p), _curve(end, p))
    gap, climb = maximum(curve[0] - along, 0), maximum(reached - curve[1] + curve[0] - along, 0)
    sticks_for = (1 - slipping) * gap / maximum(maximum(gap, climb), _TINY)
    broken = along + sticks_for * (reached - along)
    level = curve[0] + (1 + sticks_for) / 2 * (curve[1] - curve[0])
    slid = level + (broken - level) * exp(-(1 - sticks_for) * duration / (p.T * level))
    return direction * slid, (end > 0) * maximum(slipping, maximum(along - curve[0], reached - curve[1]) >= 0)


@hookimpl
def fricmodels_laws() -> list[type[Law]]:
    """Return the law of this distribution."""
    return [GeneralisedMaxwellSlip]
