"""Gravity on an unbalanced link."""

from __future__ import annotations

from fricmodels.expressions import Expression, cos, sin
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import WIDER_RANGE
from fricmodels.term import Effect, Parameters, Signals


class Gravity(Effect):
    r"""Gravity on an unbalanced link: once a turn, independent of the motion.

    .. math:: \tau = a\cos q + b\sin q

    Source: Elementary; m g r cos(q − q_0).
    """

    name = "gravity"
    formula = "τ = a·cos q + b·sin q"
    signature = "once a turn in position, independent of the direction"
    needs_motion = "a wide position range"
    separated_from = {"stiffness": WIDER_RANGE, "torque-offset": WIDER_RANGE, "asymmetry": WIDER_RANGE}
    distinct_from = frozenset({"torque-offset"})
    symmetry = "even"
    angular = True
    a = Parameter("a", unit="N m", meaning="torque in proportion to cos q")
    b = Parameter("b", unit="N m", meaning="torque in proportion to sin q")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return a cos q + b sin q."""
        return p.a * cos(s.position) + p.b * sin(s.position)
