"""Friction that grows with the torque of gravity."""

from __future__ import annotations

import math

from fricmodels.expressions import Expression, absolute, sign, sin
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class GravityFriction(Effect):
    r"""Friction that grows with the torque of gravity on a link, as in the gear that carries it.

    .. math:: \tau = c\,|\sin(q - \varphi)|\operatorname{sgn}\omega

    It is the friction of the load where no load is recorded: with a gravity of :math:`A\sin(q - \varphi)` the gear
    loses the share c/A of it. So it is considered only beside ``gravity``, whose torque vanishes at the same φ.

    Source: Coulomb's law; in gearboxes e.g. Duclusaud et al. (2025), model M3.
    """

    name = "gravity-friction"
    formula = "τ = c·|sin(q − φ)|·sgn ω"
    signature = "along the motion, in proportion to the torque of gravity"
    needs_motion = "a wide position range"
    friction = True
    only_beside = "gravity"
    separated_from = dict.fromkeys(
        ("position-friction",), "another payload: friction of the load grows with it, that of a place stays"
    )
    dissipative = True
    symmetry = "odd"
    angular = True
    c = Parameter("c", unit="N m", lower=0.0, meaning="friction torque where gravity is greatest")
    phi = Parameter(
        "phi",
        lower=-math.pi,
        upper=math.pi,
        meaning="angle in rad at which gravity has no torque",
        scan=(-1.2, -0.6, 0.0, 0.6, 1.2),
    )

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c |sin(q − φ)| sgn ω."""
        return p.c * absolute(sin(s.position - p.phi)) * sign(s.velocity)
