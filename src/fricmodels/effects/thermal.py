"""Friction that changes with temperature."""

from __future__ import annotations

from fricmodels.expressions import Expression, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class Thermal(Effect):
    r"""Viscous and Coulomb friction that change with the measured temperature ϑ.

    .. math:: \tau = a\,\omega\vartheta + b\,\vartheta\operatorname{sgn}\omega

    The law's own coefficients are then those at ϑ = 0.

    Source: Bittencourt and Gunnarsson (2012), linearised in temperature.
    """

    name = "thermal"
    formula = "τ = a·ω·ϑ + b·ϑ·sgn ω"
    signature = "along the motion, in proportion to the temperature"
    needs_motion = "a temperature that changes"
    symmetry = "odd"
    a = Parameter("a", unit="N m s/rad/K", meaning="change of the viscous coefficient per kelvin")
    b = Parameter("b", unit="N m/K", meaning="change of the Coulomb torque per kelvin")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return a ω ϑ + b ϑ sgn ω."""
        return (p.a * s.velocity + p.b * sign(s.velocity)) * s.temperature
