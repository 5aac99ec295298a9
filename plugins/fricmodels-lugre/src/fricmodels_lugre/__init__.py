"""The LuGre friction law of Canudas de Wit, Olsson, Åström and Lischinsky (1995), as a plugin of fricmodels."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels import Law, Parameter, hookimpl
from fricmodels.expressions import Expression, absolute, exp
from fricmodels.parameter import State
from fricmodels.term import Parameters, Signals

__all__ = ["LuGre", "fricmodels_laws", "from_published"]


class LuGre(Law):
    r"""Friction of elastic bristles, which bend before they slide and whose deflection falls with speed.

    The published equations are

    .. math::
        \dot z = \omega - \frac{\sigma_0 |\omega|}{g(\omega)} z, \qquad
        \tau_F = \sigma_0 z + \sigma_1 \dot z + \sigma_2 \omega, \qquad
        g(\omega) = F_c + (F_s - F_c)\,e^{-(\omega/v_s)^2}

    Here the deflection is counted in units of :math:`z_c = F_c/\sigma_0`, the one that carries the Coulomb torque, and
    :math:`r = F_s/F_c`. The equations stay the same (:func:`from_published`), and the torque is linear in F_c, σ_1
    and σ_2:

    .. math::
        \tau_F = F_c \zeta + \sigma_1 u + \sigma_2 \omega, \qquad \dot\zeta = u/z_c, \qquad
        u = \omega - \frac{|\omega|\,\zeta}{1 + (r - 1)\,e^{-(\omega/v_s)^2}}

    The deflection gives back what it stored, so the torque can push for a moment. Seen from outside, the contact takes
    more energy than it gives (it is passive) if :math:`\sigma_2 \ge \sigma_1 (F_s - F_c)/F_c`; the parameters published
    with the law do not meet that (Barabanov and Ortega 2000). Therefore it does not claim to be dissipative.

    Source: C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems with
    friction", IEEE Transactions on Automatic Control 40(3), 1995, pp. 419–425.
    """

    name = "lugre"
    formula = "τ_F = F_c·ζ + σ_1·u + σ_2·ω;  dζ/dt = u/z_c;  u = ω − |ω|·ζ/(1 + (r − 1)·exp(−(ω/v_s)²))"
    symmetry, dissipative = "odd", False
    combines = frozenset({"presliding", "stribeck", "frictional-lag", "rising-stiction"})
    F_c = Parameter("F_c", unit="N m", lower=0.0, meaning="Coulomb torque: friction of fast sliding, without σ_2")
    sigma_1 = Parameter("sigma_1", unit="N m s/rad", lower=0.0, meaning="damping of the bending contact")
    sigma_2 = Parameter("sigma_2", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    z_c = Parameter(
        "z_c",
        unit="rad",
        initial=1e-3,
        lower=1e-12,
        meaning="deflection that carries the Coulomb torque, F_c/σ_0",
        scan=(0.0001, 0.0005, 0.002, 0.005, 0.02, 0.1),
    )
    r = Parameter("r", initial=1.2, lower=1.0, meaning="stick torque over Coulomb torque, F_s/F_c", scan=(1.2, 2.0))
    v_s = Parameter(
        "v_s",
        unit="rad/s",
        initial=0.1,
        lower=1e-9,
        meaning="speed at which friction falls (Stribeck)",
        scan=(0.005, 0.02, 0.05, 0.1, 0.3),
    )
    zeta = State("zeta", meaning="deflection of the bristles over z_c")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F_c ζ + σ_1 u + σ_2 ω."""
        return p.F_c * s.zeta + p.sigma_1 * self._bending(s, p) + p.sigma_2 * s.velocity

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dζ/dt = u/z_c."""
        return {"zeta": self._bending(s, p) / p.z_c}

    def _bending(self, s: Signals, p: Parameters) -> Expression:
        """Return u, the speed at which the bristles bend."""
        longest = 1 + (p.r - 1) * exp(-((s.velocity / p.v_s) ** 2))
        return s.velocity - absolute(s.velocity) * s.zeta / longest


def from_published(
    sigma_0: float, sigma_1: float, sigma_2: float, F_c: float, F_s: float, v_s: float
) -> dict[str, float]:
    """Return the law's parameters by key from the published ones: σ_0 [N/m], σ_1, σ_2 [N s/m], F_c, F_s [N], v_s [m/s].

    On a rotary drive read N m, rad for N, m.
    """
    return {
        "F_c": F_c, "sigma_1": sigma_1, "sigma_2": sigma_2, "z_c": F_c / sigma_0, "r": F_s / F_c, "v_s": v_s
    }  # fmt: skip


@hookimpl
def fricmodels_laws() -> list[type[Law]]:
    """Return the law of this distribution."""
    return [LuGre]
