"""An inertia that is off."""

from __future__ import annotations

from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.term import Effect, Parameters, Signals


class InertiaError(Effect):
    r"""An inertia that is off by ΔJ.

    .. math:: \tau = \Delta J\,\dot\omega

    Source: Elementary; the equation of motion.
    """

    name = "inertia-error"
    formula = "τ = ΔJ·dω/dt"
    signature = "in proportion to the acceleration"
    needs_motion = "acceleration at several frequencies"
    symmetry = "even"
    dJ = Parameter("dJ", unit="kg m^2", less_of_drive=0.9, meaning="true less assumed inertia")
    """A drive with less than a tenth of it has another unit; with none, friction could balance any torque along the
    motion."""

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return ΔJ dω/dt."""
        return p.dJ * s.acceleration
