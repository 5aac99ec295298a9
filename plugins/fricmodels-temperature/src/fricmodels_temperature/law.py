"""The static friction of a robot joint under load and temperature."""

from __future__ import annotations

from fricmodels import Law, Parameter
from fricmodels.expressions import Expression, absolute, exp, power, sign, where
from fricmodels.term import Parameters, Signals
from fricmodels_temperature.printed import EXPONENT


class BittencourtGunnarsson(Law):
    r"""Coulomb, Stribeck and viscous friction that depend on load and temperature.

    .. math::
        \tau_F = \Bigl[F_{c0} + F_{cl}|\tau_L| + F_{sl}|\tau_L|\,e^{-|\omega/\phi_{sl}|^\alpha}
        + (F_{s0} + F_{sT}\vartheta)\,e^{-|\omega/(\phi_{s0} + \phi_{sT}\vartheta)|^\alpha}\Bigr]
        \operatorname{sgn}\omega + (F_{v0} + F_{vT}\,e^{-\vartheta/T_v})\,\omega

    with the temperature ϑ in °C. The load presses the surfaces together, most of all at low speed. Warm oil is thin:
    the viscous friction falls exponentially, and full lubrication begins at a higher speed, so the Stribeck friction
    grows and reaches further. A Stribeck speed that is not positive means that this part has vanished. ``F_s0`` may be
    negative, so at temperatures far below those of the recording the law can push.

    The exponent α is held at 1.36, as it is printed together with the parameters
    (:mod:`fricmodels_temperature.printed`). It is in dispute: the source may hold it at 1.3, and we have not seen its
    print. :class:`FreeExponent` estimates it.

    Source: A. C. Bittencourt, S. Gunnarsson, "Static friction in a robot joint – modeling and identification of load
    and temperature effects", Journal of Dynamic Systems, Measurement, and Control 134 (5), 051013, 2012.
    """

    name = "bittencourt-gunnarsson"
    formula = (
        "τ_F = [F_c0 + F_cl·|τ_L| + F_sl·|τ_L|·exp(−|ω/φ_sl|^1.36) + (F_s0 + F_sT·ϑ)·exp(−|ω/(φ_s0 + φ_sT·ϑ)|^1.36)]"
        "·sgn ω + (F_v0 + F_vT·exp(−ϑ/T_v))·ω, without the last part of the bracket where φ_s0 + φ_sT·ϑ ≤ 0"
    )
    dissipative = False
    symmetry = "odd"
    F_c0 = Parameter("F_c0", unit="N m", lower=0.0, meaning="Coulomb friction torque without load")
    F_cl = Parameter("F_cl", lower=0.0, meaning="Coulomb friction torque per load torque")
    F_sl = Parameter("F_sl", lower=0.0, meaning="extra friction torque at rest per load torque")
    phi_sl = Parameter(
        "phi_sl", unit="rad/s", initial=1.0, lower=1e-9, meaning="Stribeck speed of the load's part", scan=(0.02, 0.08)
    )
    F_s0 = Parameter("F_s0", unit="N m", meaning="extra friction torque at rest, at 0 °C")
    F_sT = Parameter("F_sT", unit="N m/K", meaning="its change per kelvin")
    phi_s0 = Parameter("phi_s0", unit="rad/s", meaning="Stribeck speed at 0 °C", scan=(-0.1, 0.05, 0.1))
    phi_sT = Parameter(
        "phi_sT", unit="rad/s/K", lower=0.0, meaning="change of the Stribeck speed per kelvin", scan=(0.001, 0.004)
    )
    F_v0 = Parameter("F_v0", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient of the hot joint")
    F_vT = Parameter("F_vT", unit="N m s/rad", lower=0.0, meaning="what the cold joint has more, at 0 °C")
    T_v = Parameter(
        "T_v", unit="K", initial=20.0, lower=1.0, meaning="warming that divides it by e", scan=(10.0, 20.0, 40.0)
    )

    def exponent(self, p: Parameters) -> Expression:
        """Return α."""
        return EXPONENT

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return dry friction under load, Stribeck friction at this temperature, and viscous friction at it."""
        alpha = self.exponent(p)
        load = absolute(s.load_torque)
        near_rest = exp(-power(s.velocity, alpha, p.phi_sl))
        dry = p.F_c0 + (p.F_cl + p.F_sl * near_rest) * load
        dry = dry + (p.F_s0 + p.F_sT * s.temperature) * mixed_lubrication(s, p, alpha)
        viscous = p.F_v0 + p.F_vT * exp(-s.temperature / p.T_v)
        return dry * sign(s.velocity) + viscous * s.velocity


class FreeExponent(BittencourtGunnarsson):
    r"""The law of :class:`BittencourtGunnarsson` with its exponent α as a twelfth parameter, between 1 and 2.

    At 1.36 the two are the same. A recording without Stribeck friction does not determine α.

    Source: the same; for the exponent as a parameter L.-C. Bo, D. Pavelescu, "The friction-speed relation and its
    influence on the critical velocity of stick-slip motion", Wear 82 (3), 1982.
    """

    name = "bittencourt-gunnarsson-free-exponent"
    formula = BittencourtGunnarsson.formula.replace(f"^{EXPONENT}", "^α")
    alpha = Parameter(
        "alpha", initial=1.5, lower=1.0, upper=2.0, meaning="exponent of both Stribeck terms", scan=(1.0, 1.5, 2.0)
    )

    def exponent(self, p: Parameters) -> Expression:
        """Return the parameter."""
        return p.alpha


def mixed_lubrication(s: Signals, p: Parameters, alpha: Expression) -> Expression:
    """Return the share of the Stribeck friction left at this speed and temperature: 1 at rest, 0 at speed."""
    speed = p.phi_s0 + p.phi_sT * s.temperature
    exists = speed > 0
    return where(exists, exp(-power(s.velocity, alpha, where(exists, speed, 1))), 0)
