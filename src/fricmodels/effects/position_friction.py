"""Friction that varies with position."""

from __future__ import annotations

from fricmodels.expressions import Expression, cos, sign, sin
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class PositionFriction(Effect):
    r"""Friction that varies with position: eccentricity, a bent screw, uneven preload; it flips with the direction.

    .. math:: \tau = (a\cos kq + b\sin kq)\operatorname{sgn}\omega

    The wave number k [1/rad or 1/m] is searched for; a period need not divide a turn.

    Source: Armstrong-Hélouvry, Control of Machines with Friction (1991), ch. 4.
    """

    name = "position-friction"
    formula = "τ = (a·cos kq + b·sin kq)·sgn ω"
    signature = "periodic in position, flipping with the direction"
    needs_motion = "several periods in position"
    symmetry = "odd"
    a = Parameter("a", unit="N m", meaning="cosine amplitude")
    b = Parameter("b", unit="N m", meaning="sine amplitude")
    k = Parameter("k", unit="1/rad", initial=1.0, lower=0.0, meaning="wave number over position", periodic=True)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the periodic torque."""
        return (p.a * cos(p.k * s.position) + p.b * sin(p.k * s.position)) * sign(s.velocity)
