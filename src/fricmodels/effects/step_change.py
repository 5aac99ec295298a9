"""Friction that jumps at one instant."""

from __future__ import annotations

from fricmodels.expressions import Expression, sign, where
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class StepChange(Effect):
    r"""Friction or load that jumps at one instant: a fault, a brake, a dropped payload.

    .. math:: \tau = (c \operatorname{sgn}\omega + d)\,(t \ge t_0)

    Source: Elementary; change detection as in Basseville and Nikiforov (1993).
    """

    name = "step-change"
    formula = "τ = (c·sgn ω + d) for t ≥ t_0, else 0"
    signature = "a jump at one instant"
    needs_motion = "motion before and after the jump"
    depends_on_time = True
    c = Parameter("c", unit="N m", meaning="jump of the Coulomb torque")
    d = Parameter("d", unit="N m", meaning="jump of the constant torque")
    t_0 = Parameter(
        "t_0",
        unit="s",
        meaning="instant of the jump, after the first sample",
        instant=True,
        scan=tuple(round(0.05 * i, 2) for i in range(1, 20)),
    )

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return c sgn ω + d from t_0 on."""
        return (p.c * sign(s.velocity) + p.d) * where(s.time >= p.t_0, 1, 0)
