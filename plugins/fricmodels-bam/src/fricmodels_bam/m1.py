"""M1: Coulomb and viscous friction, and what all six laws have in common."""

from __future__ import annotations

from typing import ClassVar, Literal

from fricmodels import Law, Parameter
from fricmodels.expressions import Expression, absolute, sign
from fricmodels.term import Parameters, Signals


class CoulombViscous(Law):
    r"""Coulomb and viscous friction; the laws M2 to M6 add to the torque that the gearbox can hold.

    .. math:: \tau_F = K_v\omega + \tau_{dry}\operatorname{sgn}\omega, \qquad \tau_{dry} = K_c

    Source: M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended friction models for the physics simulation of servo
    actuators", IEEE International Conference on Robotics and Automation, 2025, model M1.
    """

    name = "bam-m1"
    formula = "τ_F = K_v·ω + K_c·sgn ω"
    symmetry: ClassVar[Literal["odd", "even"] | None] = "odd"
    same_as: ClassVar[frozenset[str]] = frozenset({"coulomb-viscous"})
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="Coulomb friction torque")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the viscous torque and the dry friction, both along the motion."""
        return p.K_v * s.velocity + self.dry(s, p) * sign(s.velocity)

    def dry(self, s: Signals, p: Parameters) -> Expression:
        """Return the magnitude of the friction torque that does not grow with the speed [N m]."""
        return p.K_c


def transmitted(s: Signals) -> Expression:
    """Return the torque that the gearbox transmits, |τ_m + τ_L| [N m].

    The source counts the torque τ_e that the outside exerts on the joint, ``J dω/dt = τ_m + τ_e − τ_F``; here the load
    torque is what the motor has to overcome, τ_L = −τ_e. A motor that holds a load, τ_m = τ_L, loads the gearbox twice.
    """
    return absolute(s.motor_torque + s.load_torque)
