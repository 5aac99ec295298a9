"""Friction that grows with the load."""

from __future__ import annotations

from fricmodels.expressions import Expression, absolute, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class LoadFriction(Effect):
    r"""Friction that grows with the load, as in gears and screws.

    .. math:: \tau = \mu\,|\tau_L|\operatorname{sgn}\omega

    Source: Coulomb's law; in gearboxes e.g. Duclusaud et al. (2025), model M3.
    """

    name = "load-friction"
    formula = "τ = μ·|τ_L|·sgn ω"
    signature = "along the motion, in proportion to the load"
    needs_motion = "a varying load"
    friction = True
    separated_from = {"directional-efficiency": "the same load driven and driven back at equal speeds"}
    dissipative = True
    symmetry = "odd"
    mu = Parameter("mu", lower=0.0, meaning="friction torque per load torque")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return μ |τ_L| sgn ω."""
        return p.mu * absolute(s.load_torque) * sign(s.velocity)
