"""Friction that changes slowly with time."""

from __future__ import annotations

from fricmodels.expressions import Expression, exp, sign
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import NEW_RECORD
from fricmodels.term import Effect, Parameters, Signals


class Drift(Effect):
    r"""Viscous and Coulomb friction that change slowly with time: run-in, warming without a thermometer.

    .. math:: \tau = (a\,\omega + b\operatorname{sgn}\omega)\,T\,(1 - e^{-t/T})

    a and b are the rates at the beginning; after a time T the change comes to its end. Over times much shorter than T
    it is the straight line (a ω + b sgn ω) t.

    Source: Elementary; the step response of a first order, such as a housing that warms.
    """

    name = "drift"
    formula = "τ = (a·ω + b·sgn ω)·T·(1 − exp(−t/T))"
    signature = "along the motion, growing or falling with time"
    needs_motion = "a long record"
    friction = True
    separated_from = {"step-change": NEW_RECORD}
    symmetry = "odd"
    depends_on_time = True
    a = Parameter("a", unit="N m/rad", meaning="change of the viscous coefficient per second, at first")
    b = Parameter("b", unit="N m/s", meaning="change of the Coulomb torque per second, at first")
    T = Parameter(
        "T", unit="s", initial=100.0, lower=1e-9, meaning="time of the change", slow=True, scan=(0.1, 0.3, 1.0, 3.0)
    )

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return (a ω + b sgn ω) T (1 − exp(−t/T))."""
        return (p.a * s.velocity + p.b * sign(s.velocity)) * p.T * (1 - exp(-s.time / p.T))
