"""A delay between the recorded torque and the recorded motion."""

from __future__ import annotations

from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter
from fricmodels.results.experiments import SEVERAL_FREQUENCIES
from fricmodels.term import Effect, Parameters, Signals


class SensorDelay(Effect):
    r"""Torque and motion that were not recorded at the same time: with T > 0 the motion is late, with T < 0 the torque.

    .. math:: \tau = T\,\dot\tau_m

    The first order of a shift, :math:`\tau_m(t - T) = \tau_m(t) - T\dot\tau_m(t) + \dots`. A torque held over a sample
    of length h by itself gives T = h/2. Estimators fit the first order. Where T is known, scores, simulations
    and the diagnosis take the whole shift: with T > 0 the motion was recorded late, after motor torque and load torque,
    with T < 0 only the motor torque was; see :meth:`fricmodels.recording.Recording.retimed`.

    Source: elementary.
    """

    name = "sensor-delay"
    formula = "τ = T·dτ_m/dt"
    signature = "the derivative of the motor torque"
    needs_motion = "several frequencies"
    separated_from = dict.fromkeys(("inertia-error", "frictional-lag", "joint-compliance"), SEVERAL_FREQUENCIES)
    symmetry = "even"
    T = Parameter("T", unit="s", delay=True, meaning="delay of the recorded motion; of the recorded torque if negative")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return T dτ_m/dt."""
        return p.T * s.motor_torque_rate
