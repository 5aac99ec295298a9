"""Friction that varies with position."""

from __future__ import annotations

from fricmodels.effects.wave import Wave
from fricmodels.expressions import Expression, cos, sign, sin
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import BOTH_DIRECTIONS
from fricmodels.term import Parameters, Signals


class PositionFriction(Wave):
    r"""Friction that varies with position: eccentricity, a bent screw, uneven preload; it flips with the direction.

    .. math:: \tau = (a\cos kq + b\sin kq + a_2\cos 2kq + b_2\sin 2kq)\operatorname{sgn}\omega

    The wave number k [1/rad or 1/m] is searched for; a period need not divide a turn. Few periodic torques are pure
    sines, so the second harmonic belongs to them.

    Source: Armstrong-Hélouvry, Control of Machines with Friction (1991), ch. 4.
    """

    name = "position-friction"
    formula = "τ = (a·cos kq + b·sin kq + a_2·cos 2kq + b_2·sin 2kq)·sgn ω"
    signature = "periodic in position, flipping with the direction"
    needs_motion = "several periods in position"
    friction = True
    separated_from = dict.fromkeys(("cogging", "torque-ripple", "gravity", "stiffness"), BOTH_DIRECTIONS)
    symmetry = "odd"
    a = Parameter("a", unit="N m", meaning="cosine amplitude")
    b = Parameter("b", unit="N m", meaning="sine amplitude")
    a_2 = Parameter("a_2", unit="N m", meaning="cosine amplitude of the second harmonic")
    b_2 = Parameter("b_2", unit="N m", meaning="sine amplitude of the second harmonic")
    k = Parameter("k", unit="1/rad", initial=1.0, lower=0.0, meaning="wave number over position", periodic=True)

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return both waves of the periodic torque."""
        first, second = p.k * s.position, 2 * p.k * s.position
        waves = p.a * cos(first) + p.b * sin(first) + p.a_2 * cos(second) + p.b_2 * sin(second)
        return waves * sign(s.velocity)
