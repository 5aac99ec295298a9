"""A spring."""

from __future__ import annotations

from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import NEW_RECORD, WIDER_RANGE
from fricmodels.term import Effect, Parameters, Signals


class Stiffness(Effect):
    r"""A spring: a cable, a hose, a counterbalance, at rest too.

    .. math:: \tau = k q + \tau_0

    The zero of the position sensor is not that of the spring, so a constant belongs to it: q_0 = −τ_0/k.

    Source: Elementary; Hooke's law.
    """

    name = "stiffness"
    formula = "τ = k·q + τ_0"
    signature = "in proportion to position, at rest too"
    needs_motion = "a wide position range"
    separated_from = {"asymmetry": WIDER_RANGE, "step-change": NEW_RECORD}
    symmetry = "even"
    k = Parameter("k", unit="N m/rad", meaning="stiffness")
    tau_0 = Parameter("tau_0", unit="N m", meaning="torque of the spring at q = 0")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return k q + τ_0."""
        return p.k * s.position + p.tau_0
