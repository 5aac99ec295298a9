"""A constant torque."""

from __future__ import annotations

from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import ANOTHER_LOAD, NEW_RECORD, WIDER_RANGE
from fricmodels.term import Effect, Parameters, Signals


class TorqueOffset(Effect):
    r"""A constant torque, at rest too: a bias of the torque sensor or a constant load.

    .. math:: \tau = \tau_0

    Source: Janot, Gautier and Brunot (2019), the offset of the EMPS reference model.
    """

    name = "torque-offset"
    formula = "τ = τ_0"
    signature = "a constant, at rest too"
    needs_motion = "motion in both directions"
    separated_from = {
        "stiffness": WIDER_RANGE,
        "step-change": NEW_RECORD,
        "directional-efficiency": ANOTHER_LOAD,
    }
    symmetry = "even"
    tau_0 = Parameter("tau_0", unit="N m", meaning="constant torque")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the constant torque."""
        return p.tau_0
