"""Torque ripple of commutation."""

from __future__ import annotations

from fricmodels.effects.wave import Wave
from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import BOTH_DIRECTIONS
from fricmodels.term import Parameters, Signals


class TorqueRipple(Wave):
    r"""Ripple of commutation and of current gains: periodic in position, in proportion to the motor torque.

    .. math:: \tau = \tau_m\,(a\cos kq + b\sin kq + a_2\cos 2kq + b_2\sin 2kq)

    The wave number k [1/rad or 1/m] is searched for; a period need not divide a turn. Few periodic torques are pure
    sines, so the second harmonic belongs to them.

    Source: Jahns and Soong (1996), pulsating torque minimisation.
    """

    name = "torque-ripple"
    formula = "τ = τ_m·(a·cos kq + b·sin kq + a_2·cos 2kq + b_2·sin 2kq)"
    signature = "periodic in position, in proportion to the motor torque"
    needs_motion = "several periods in position"
    separated_from = dict.fromkeys(("cogging", "gravity", "stiffness"), BOTH_DIRECTIONS)
    symmetry = "even"
    a = Parameter("a", meaning="cosine amplitude")
    b = Parameter("b", meaning="sine amplitude")
    a_2 = Parameter("a_2", meaning="cosine amplitude of the second harmonic")
    b_2 = Parameter("b_2", meaning="sine amplitude of the second harmonic")
    k = Parameter("k", unit="1/rad", initial=1.0, lower=0.0, meaning="wave number over position", periodic=True)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return both waves of the periodic torque."""
        first, second = p.k * s.position, 2 * p.k * s.position
        waves = p.a * cos(first) + p.b * sin(first) + p.a_2 * cos(second) + p.b_2 * sin(second)
        return waves * s.motor_torque
