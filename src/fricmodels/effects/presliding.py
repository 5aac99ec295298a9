"""Elastic presliding of the contact."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, negative, positive
from fricmodels.parameter import Parameter, State
from fricmodels.results.experiments import SMALL_REVERSALS
from fricmodels.term import Effect, Parameters, Signals


class Presliding(Effect):
    r"""The contact first bends before it slides: after a reversal friction builds up over a fixed distance (Dahl).

    .. math::
        \tau = F_z\,z - F_\omega \operatorname{sgn}\omega + D\,(\omega - |\omega| z), \qquad
        \dot z = (\omega - |\omega| z)/x_s

    Where a law's Coulomb torque jumps at a reversal, this term takes the jump away and gives it back over the
    displacement x_s: z follows sgn ω as 1 − 2 exp(−|q − q_r|/x_s) after a reversal at q_r. D is the damping of the
    contact while it bends (LuGre); Dahl's model is D = 0. F_ω is F_1 for ω ≥ 0 and F_2 for ω < 0: a drive may run
    harder in one direction. F_z is F_1 for z ≥ 0 and F_2 for z < 0: a contact is as strong as in the direction in which
    it is bent. It stores :math:`W = F_z x_s z^2/2`, and of the power :math:`F_z z\,\omega = \dot W + F_z|\omega| z^2`
    it keeps the rest: it gives back no more than it took. (With F_ω in the place of F_z it would: W taken at F_1, given
    back at F_2.)

    Source: Dahl (1968); steady sliding of LuGre, Canudas de Wit et al. (1995).
    """

    name = "presliding"
    formula = (
        "τ = (F_1 for z ≥ 0, F_2 for z < 0)·z − (F_1 for ω ≥ 0, F_2 for ω < 0)·sgn ω + D·(ω − |ω|·z);  "
        "dz/dt = (ω − |ω|·z)/x_s"
    )
    signature = "a hysteresis loop in position after each reversal, of fixed width"
    needs_motion = "reversals"
    separated_from = dict.fromkeys(
        ("backlash", "stribeck", "nonlinear-viscous", "rising-stiction", "frictional-lag", "sensor-delay"),
        SMALL_REVERSALS,
    )
    F_1 = Parameter(
        "F_1", unit="N m", lower=0.0, meaning="friction torque that builds up elastically, positive rotation"
    )
    F_2 = Parameter(
        "F_2", unit="N m", lower=0.0, meaning="friction torque that builds up elastically, negative rotation"
    )
    D = Parameter("D", unit="N m s/rad", lower=0.0, accompanies=True, meaning="damping of the bending contact")
    x_s = Parameter(
        "x_s",
        unit="rad",
        initial=1e-3,
        lower=1e-12,
        meaning="displacement over which it builds up",
        scan=(0.00005, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05),
    )
    z = State("z", meaning="deflection of the contact, −1 to 1")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F_z z − F_ω sgn ω + D (ω − |ω| z)."""
        bent = (p.F_1 * (absolute(s.z) + s.z) - p.F_2 * (absolute(s.z) - s.z)) / 2
        sliding = p.F_1 * positive(s.velocity) - p.F_2 * negative(s.velocity)
        return bent - sliding + p.D * (s.velocity - absolute(s.velocity) * s.z)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dz/dt = (ω − |ω| z)/x_s."""
        return {"z": (s.velocity - absolute(s.velocity) * s.z) / p.x_s}
