"""Friction that changes with temperature."""

from __future__ import annotations

from fricmodels.expressions import Expression, sign
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class Thermal(Effect):
    r"""Viscous and Coulomb friction that change with the measured temperature ϑ.

    .. math:: \tau = (a\,\vartheta + c\,\vartheta^2)\,\omega + b\,\vartheta\operatorname{sgn}\omega

    The law's own coefficients are then those at ϑ = 0. Lubricants thin exponentially; the square follows that over the
    temperatures of one recording.

    Source: Bittencourt and Gunnarsson (2012), expanded in temperature.
    """

    name = "thermal"
    formula = "τ = (a·ϑ + c·ϑ²)·ω + b·ϑ·sgn ω"
    signature = "along the motion, changing with the temperature"
    needs_motion = "a temperature that changes"
    symmetry = "odd"
    a = Parameter("a", unit="N m s/rad/K", meaning="change of the viscous coefficient per kelvin")
    b = Parameter("b", unit="N m/K", meaning="change of the Coulomb torque per kelvin")
    c = Parameter("c", unit="N m s/rad/K^2", meaning="curvature of the viscous coefficient over temperature")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return (a ϑ + c ϑ²) ω + b ϑ sgn ω."""
        viscous = p.a * s.temperature + p.c * s.temperature**2
        return viscous * s.velocity + p.b * s.temperature * sign(s.velocity)
