"""The friction laws M1 to M6 of Duclusaud, Passault, Padois and Ly (2025), and the servo, as plugins of fricmodels."""

from __future__ import annotations

from fricmodels import Law, hookimpl
from fricmodels.loop import Loop
from fricmodels_bam.firmware import Firmware, SaggingSupply
from fricmodels_bam.m1 import CoulombViscous
from fricmodels_bam.m2 import Stribeck
from fricmodels_bam.m3 import LoadDependent
from fricmodels_bam.m4 import StribeckLoadDependent
from fricmodels_bam.m5 import Directional
from fricmodels_bam.m6 import Quadratic

__all__ = [
    "LAWS",
    "CoulombViscous",
    "Directional",
    "Firmware",
    "LoadDependent",
    "Quadratic",
    "SaggingSupply",
    "Stribeck",
    "StribeckLoadDependent",
    "fricmodels_controllers",
    "fricmodels_laws",
]

LAWS: tuple[type[CoulombViscous], ...] = (
    CoulombViscous,
    Stribeck,
    LoadDependent,
    StribeckLoadDependent,
    Directional,
    Quadratic,
)
"""M1 to M6, in order."""


@hookimpl
def fricmodels_laws() -> list[type[Law]]:
    """Return the laws of this distribution."""
    return list(LAWS)


@hookimpl
def fricmodels_controllers() -> list[type[Loop]]:
    """Return the servo on the bench, with a stiff supply and with one that sags."""
    return [Firmware, SaggingSupply]
