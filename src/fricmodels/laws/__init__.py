"""The built-in friction laws, one a file, registered through the same hook as anybody's."""

from __future__ import annotations

from fricmodels.hookspecs import hookimpl
from fricmodels.laws.asymmetric_coulomb_viscous import AsymmetricCoulombViscous
from fricmodels.laws.asymmetric_exponential_stick_slip import AsymmetricExponentialStickSlip
from fricmodels.laws.coulomb_viscous import CoulombViscous
from fricmodels.laws.exponential_stick_slip import ExponentialStickSlip
from fricmodels.laws.square_root import SquareRoot
from fricmodels.laws.two_thirds_power import TwoThirdsPower
from fricmodels.term import Law


@hookimpl
def fricmodels_laws() -> list[type[Law]]:
    """Return the built-in laws."""
    return [
        CoulombViscous,
        AsymmetricCoulombViscous,
        ExponentialStickSlip,
        AsymmetricExponentialStickSlip,
        SquareRoot,
        TwoThirdsPower,
    ]
