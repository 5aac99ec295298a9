"""Viscous friction that is not proportional to speed."""

from __future__ import annotations

from fricmodels.expressions import Expression, power, sign
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import SMALL_REVERSALS
from fricmodels.term import Effect, Parameters, Signals


class NonlinearViscous(Effect):
    r"""Viscous friction that is not proportional to speed.

    .. math:: \tau = (a\,|\omega|^{1/2} + b\,\omega^2)\operatorname{sgn}\omega

    Beside a law's Coulomb and viscous parts these two bend the curve down (lubricated bearings, |ω|^(1/2), |ω|^(2/3))
    or up (drag, ω², |ω|³); over the speeds of one recording other powers are close to combinations of them.

    Source: Canudas de Wit et al. (1987) for the root; quadratic drag of fluids.
    """

    name = "nonlinear-viscous"
    formula = "τ = (a·|ω|^(1/2) + b·ω²)·sgn ω"
    signature = "along the motion, curved over speed"
    needs_motion = "a wide speed range"
    friction = True
    separated_from = dict.fromkeys(("rising-stiction", "frictional-lag"), SMALL_REVERSALS)
    symmetry = "odd"
    a = Parameter("a", unit="N m s^(1/2)/rad^(1/2)", lower=0.0, meaning="coefficient of the square root of speed")
    b = Parameter("b", unit="N m s^2/rad^2", meaning="coefficient of the square of speed")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return (a |ω|^(1/2) + b ω²) sgn ω."""
        return (p.a * power(s.velocity, 0.5) + p.b * s.velocity**2) * sign(s.velocity)
