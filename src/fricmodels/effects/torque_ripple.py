"""Torque ripple of commutation."""

from __future__ import annotations

from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class TorqueRipple(Effect):
    r"""Ripple of commutation and of current gains: periodic in position, in proportion to the motor torque.

    .. math:: \tau = \tau_m\,(a\cos kq + b\sin kq)

    The wave number k [1/rad or 1/m] is searched for; a period need not divide a turn.

    Source: Jahns and Soong (1996), pulsating torque minimisation.
    """

    name = "torque-ripple"
    formula = "τ = τ_m·(a·cos kq + b·sin kq)"
    signature = "periodic in position, in proportion to the motor torque"
    needs_motion = "several periods in position"
    symmetry = "even"
    a = Parameter("a", meaning="cosine amplitude")
    b = Parameter("b", meaning="sine amplitude")
    k = Parameter("k", unit="1/rad", initial=1.0, lower=0.0, meaning="wave number over position", periodic=True)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the periodic torque."""
        return (p.a * cos(p.k * s.position) + p.b * sin(p.k * s.position)) * s.motor_torque
