"""Load- and temperature-dependent friction of robot joints (Bittencourt and Gunnarsson 2012) for fricmodels."""

from __future__ import annotations

from fricmodels import Law, hookimpl
from fricmodels_temperature.law import BittencourtGunnarsson, FreeExponent

__all__ = ["BittencourtGunnarsson", "FreeExponent", "fricmodels_laws"]


@hookimpl
def fricmodels_laws() -> list[type[Law]]:
    """Return the laws of this distribution."""
    return [BittencourtGunnarsson, FreeExponent]
