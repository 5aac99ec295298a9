"""A law with a deflection is odd if it turns over together with that."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from fricmodels.expressions import Expression, absolute
from fricmodels.parameter import Parameter
from fricmodels.term import Law, Parameters, Signals, State
from fricmodels.testing.faults import Fault
from fricmodels.testing.subject import subject
from fricmodels.testing.term_checks import check_symmetry


class Dahl(Law):
    """Friction of a contact that bends, τ = F z + K_v ω with dz/dt = (ω − |ω| z)/x_s (P. R. Dahl, 1968)."""

    name = "dahl-of-this-test"
    formula = "τ_F = F·z + K_v·ω; dz/dt = (ω − |ω|·z)/x_s"
    symmetry = "odd"
    F = Parameter("F", unit="N m", lower=0.0, meaning="friction of sliding")
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    x_s = Parameter("x_s", unit="rad", initial=0.01, lower=1e-9, meaning="distance over which it bends", scan=(0.01,))
    z = State("z", meaning="deflection")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F z + K_v ω."""
        return p.F * s.z + p.K_v * s.velocity

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return dz/dt."""
        return {"z": (s.velocity - absolute(s.velocity) * s.z) / p.x_s}


class Bent(Dahl):
    """The same with a part that does not turn over."""

    name = "bent-of-this-test"

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return F |z| + K_v ω."""
        return p.F * absolute(s.z) + p.K_v * s.velocity


def test_a_deflection_turns_over_with_the_velocity() -> None:
    check_symmetry(subject(Dahl))


def test_what_does_not_is_caught() -> None:
    with pytest.raises(Fault, match="the directions differ in size"):
        check_symmetry(subject(Bent))
