"""Cogging torque."""

from __future__ import annotations

from fricmodels.effects.wave import Wave
from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import WIDER_RANGE
from fricmodels.term import Parameters, Signals


class Cogging(Wave):
    r"""Torque of poles, slots or teeth: periodic in position, independent of the motion.

    .. math:: \tau = a\cos kq + b\sin kq + a_2\cos 2kq + b_2\sin 2kq

    The wave number k [1/rad or 1/m] is searched for; a period need not divide a turn. Few periodic torques are pure
    sines, so the second harmonic belongs to them.

    Source: Hanselman, Brushless Permanent Magnet Motor Design (2006), ch. 9.
    """

    name = "cogging"
    formula = "τ = a·cos kq + b·sin kq + a_2·cos 2kq + b_2·sin 2kq"
    signature = "periodic in position, the same in both directions"
    needs_motion = "several periods in position"
    separated_from = dict.fromkeys(("gravity", "stiffness"), WIDER_RANGE)
    symmetry = "even"
    a = Parameter("a", unit="N m", meaning="cosine amplitude")
    b = Parameter("b", unit="N m", meaning="sine amplitude")
    a_2 = Parameter("a_2", unit="N m", meaning="cosine amplitude of the second harmonic")
    b_2 = Parameter("b_2", unit="N m", meaning="sine amplitude of the second harmonic")
    k = Parameter(
        "k",
        unit="1/rad",
        initial=2.0,
        lower=0.0,
        meaning="wave number over position",
        periodic=True,
        not_between=(2 / 3, 1.5),
    )

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return both waves of the periodic torque."""
        first, second = p.k * s.position, 2 * p.k * s.position
        return p.a * cos(first) + p.b * sin(first) + p.a_2 * cos(second) + p.b_2 * sin(second)
