"""The friction law of Makkar, Dixon, Sawyer and Hu (2005), as a plugin of fricmodels."""

from __future__ import annotations

from typing import ClassVar

from fricmodels import Law, Parameter, hookimpl
from fricmodels.expressions import Expression, tanh
from fricmodels.term import Parameters, Signals

__all__ = ["MakkarDixonSawyerHu", "fricmodels_laws"]


class MakkarDixonSawyerHu(Law):
    r"""Continuously differentiable friction: smooth Coulomb and viscous friction with a Stribeck peak.

    .. math::
        \tau_F = \gamma_1(\tanh\gamma_2\omega - \tanh\gamma_3\omega) + \gamma_4\tanh\gamma_5\omega + \gamma_6\omega

    With γ2 ≥ γ3 the first term is the peak at low speed. The friction torque is zero at rest and nothing sticks;
    a drive that is at rest under torque creeps.

    Source: C. Makkar, W. E. Dixon, W. G. Sawyer, G. Hu, "A new continuously differentiable friction model for
    control systems design", Proc. IEEE/ASME AIM, 2005, eq. 1.
    """

    name = "makkar"
    formula = "τ_F = γ1·(tanh γ2·ω − tanh γ3·ω) + γ4·tanh γ5·ω + γ6·ω"
    # The peak and the Coulomb torque rise at speeds that can be told apart.
    exam: ClassVar = {
        "truth": {"gamma_1": 0.15, "gamma_2": 2.0, "gamma_3": 0.3, "gamma_4": 0.12, "gamma_5": 20.0, "gamma_6": 0.01}
    }
    gamma_1 = Parameter("gamma_1", unit="N m", lower=0.0, meaning="height of the peak at low speed")
    gamma_2 = Parameter(
        "gamma_2", unit="s/rad", lower=0.0, at_least="gamma_3", meaning="rise of the peak", scan=(100.0, 30.0)
    )
    gamma_3 = Parameter("gamma_3", unit="s/rad", lower=0.0, meaning="fall of the peak", scan=(10.0, 3.0))
    gamma_4 = Parameter("gamma_4", unit="N m", lower=0.0, meaning="Coulomb friction torque")
    gamma_5 = Parameter(
        "gamma_5", unit="s/rad", lower=0.0, meaning="rise of the Coulomb torque at rest", scan=(300.0, 100.0, 30.0)
    )
    gamma_6 = Parameter("gamma_6", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque of the formula."""
        peak = p.gamma_1 * (tanh(p.gamma_2 * s.velocity) - tanh(p.gamma_3 * s.velocity))
        return peak + p.gamma_4 * tanh(p.gamma_5 * s.velocity) + p.gamma_6 * s.velocity


@hookimpl
def fricmodels_laws() -> list[type[Law]]:
    """Return the law of this distribution."""
    return [MakkarDixonSawyerHu]
