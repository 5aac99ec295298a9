"""Friction that changes with temperature."""

from __future__ import annotations

from fricmodels.expressions import Expression, exp, sign
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import WARM_START
from fricmodels.term import Effect, Parameters, Signals


class Thermal(Effect):
    r"""Viscous and Coulomb friction that change with the measured temperature ϑ.

    .. math:: \tau = a\,\vartheta_v\,(1 - e^{-\vartheta/\vartheta_v})\,\omega + b\,\vartheta\operatorname{sgn}\omega

    The law's own coefficients are then those at ϑ = 0, and a and b the rates there. A lubricant thins exponentially,
    by a factor of e in ϑ_v; over much less than that the change is the straight line a ϑ ω. None does so in less than
    10 K: below, a ϑ_v ω alone would be left, which is the law's own.

    Source: Bittencourt and Gunnarsson (2012); Reynolds' law of viscosity.
    """

    name = "thermal"
    formula = "τ = a·ϑ_v·(1 − exp(−ϑ/ϑ_v))·ω + b·ϑ·sgn ω"
    signature = "along the motion, changing with the temperature"
    needs_motion = "a temperature that changes"
    friction = True
    separated_from = dict.fromkeys(("drift", "step-change"), WARM_START)
    symmetry = "odd"
    a = Parameter("a", unit="N m s/rad/K", meaning="change of the viscous coefficient per kelvin, at 0 °C")
    b = Parameter("b", unit="N m/K", meaning="change of the Coulomb torque per kelvin")
    theta_v = Parameter(
        "theta_v",
        unit="K",
        initial=50.0,
        lower=10.0,
        upper=1e5,
        meaning="warming by which a lubricant thins by a factor of e",
        scan=(10.0, 30.0, 100.0, 1000.0),
    )

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return a ϑ_v (1 − exp(−ϑ/ϑ_v)) ω + b ϑ sgn ω."""
        viscous = p.a * p.theta_v * (1 - exp(-s.temperature / p.theta_v))
        return viscous * s.velocity + p.b * s.temperature * sign(s.velocity)
