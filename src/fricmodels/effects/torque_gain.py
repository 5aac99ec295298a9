"""A torque constant that is off."""

from __future__ import annotations

from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import SEVERAL_FREQUENCIES
from fricmodels.term import Effect, Parameters, Signals


class TorqueGain(Effect):
    r"""A torque constant that is off: the motor gives 1 + g times the torque that was recorded.

    .. math:: \tau = -g\,\tau_m

    Source: Elementary; the scale of the current or torque measurement.
    """

    name = "torque-gain"
    formula = "τ = −g·τ_m"
    signature = "in proportion to the motor torque"
    needs_motion = "a known inertia or load"
    separated_from = {
        "inertia-error": "a known load: add a weight of known torque or inertia and repeat",
        "gravity": "another payload: gravity changes with it, the torque constant does not",
        "directional-efficiency": "a run without load: losses under load vanish with it",
        **dict.fromkeys(("sensor-delay", "joint-compliance"), SEVERAL_FREQUENCIES),
    }
    symmetry = "even"
    g = Parameter("g", lower=-0.9, upper=0.9, meaning="relative error of the torque constant")
    """A constant that is off by more than nine tenths is another unit, or the wrong column."""

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return −g τ_m."""
        return -p.g * s.motor_torque
