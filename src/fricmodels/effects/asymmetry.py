"""Friction that differs between the directions."""

from __future__ import annotations

from fricmodels.expressions import Expression, absolute
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import ANOTHER_LOAD, NEW_RECORD
from fricmodels.term import Effect, Parameters, Signals


class Asymmetry(Effect):
    r"""Friction that differs between the directions, added to a symmetric law.

    .. math:: \tau = c + d\,|\omega|

    With a symmetric law K_v, K_c the coefficients are K_c + c and K_v + d forward, K_c − c and K_v − d backward.

    Source: Elhami and Brookfield (1997), who found K_c1 some 30 % above K_c2.
    """

    name = "asymmetry"
    formula = "τ = c + d·|ω|"
    signature = "positive and negative motion differ by a constant, by a slope in speed, or both"
    needs_motion = "motion in both directions"
    friction = True
    separated_from = {
        "torque-offset": "a static test: hold the drive at rest without torque, or turn it over by hand; an offset is "
        "there at rest too",
        "step-change": NEW_RECORD,
        "directional-efficiency": ANOTHER_LOAD,
    }
    symmetry = "even"
    distinct_from = frozenset({"torque-offset"})
    c = Parameter("c", unit="N m", meaning="half the difference of the Coulomb torques, forward less backward")
    d = Parameter("d", unit="N m s/rad", meaning="half the difference of the viscous coefficients")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c + d |ω|."""
        return p.c + p.d * absolute(s.velocity)
