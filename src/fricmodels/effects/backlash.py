"""Play between motor and load."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, sign, where
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Parameters, Signals


class Backlash(Effect):
    r"""Play: after a reversal the motor crosses a gap of width w without the load's friction.

    .. math:: \tau = -F\,(|z| < 1)\operatorname{sgn}\omega, \qquad \dot z = 2\omega/w \text{ within } |z| \le 1

    z runs from −1 to 1 across the gap and stays at its ends.

    Source: Nordin and Gutman (2002), the dead zone model at low impact.
    """

    name = "backlash"
    formula = "τ = −F·sgn ω within the gap;  gap crossed over w after a reversal"
    signature = "a pulse after each reversal, of fixed width in position"
    needs_motion = "position, reversals"
    F = Parameter("F", unit="N m", meaning="friction torque of the load, missing within the gap")
    w = Parameter(
        "w",
        unit="rad",
        initial=1e-3,
        lower=1e-12,
        meaning="width of the gap",
        scan=(0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1),
    )
    z = State("z", meaning="place within the gap, −1 to 1")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return −F sgn ω while the gap is open."""
        open_gap = where(absolute(s.z) < 0.999, 1, 0)
        return -p.F * open_gap * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dz/dt = 2 ω/w inside the gap, 0 at the end that it is pushed against."""
        blocked = where(s.z * sign(s.velocity) >= 1, 1, 0)
        return {"z": (1 - blocked) * 2 * s.velocity / p.w}
