"""A breakaway torque that grows with the time at rest."""

from __future__ import annotations

from collections.abc import Mapping

from fricmodels.expressions import Expression, absolute, sign
from fricmodels.parameter import Parameter, State
from fricmodels.term import Effect, Parameters, Signals


class RisingStiction(Effect):
    r"""A contact that ages: at rest the breakaway torque rises with time, and sliding over x_s wears the bond off.

    .. math:: \tau = F z \operatorname{sgn}\omega, \qquad \dot z = (1 - z)/T - |\omega| z/x_s

    After rests that are all short against T, only F/T is to be told. At constant speed z = 1/(1 + |ω| T/x_s), and it
    follows the speed late: a falling friction with a lag of the first order looks the same.

    Source: Rabinowicz (1958); rate and state friction, Dieterich (1979), Ruina (1983).
    """

    name = "rising-stiction"
    formula = "τ = F·z·sgn ω;  dz/dt = (1 − z)/T − |ω|·z/x_s"
    signature = (
        "a breakaway peak that grows with the time at rest; sliding, it falls with the speed and follows it late"
    )
    needs_motion = "rests of different lengths"
    friction = True
    F = Parameter("F", unit="N m", lower=0.0, meaning="rise of the breakaway torque after a long rest")
    T = Parameter(
        "T",
        unit="s",
        initial=1.0,
        lower=1e-9,
        meaning="time of the rise",
        own_time=True,
        scan=(0.003, 0.01, 0.03, 0.1),
        doubtful_ends=("lower",),
    )
    x_s = Parameter(
        "x_s",
        unit="rad",
        initial=1e-3,
        lower=1e-12,
        meaning="sliding that ends it",
        scan=(0.001, 0.003, 0.01, 0.03),
    )
    beginning_unknown = True
    z = State("z", lower=0.0, upper=1.0, meaning="age of the contact")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F z sgn ω."""
        return p.F * s.z * sign(s.velocity)

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dz/dt = (1 − z)/T − |ω| z/x_s."""
        return {"z": (1 - s.z) / p.T - absolute(s.velocity) * s.z / p.x_s}
