"""The effects that a simulated drive can hide, as ``effects:`` in a rig file lists them.

On a linear axis read N for N m and m for rad.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fricmodels.rig.memory import (
    Backlash,
    Drift,
    FrictionalLag,
    JointCompliance,
    Presliding,
    RisingStiction,
    SensorDelay,
    StepChange,
    Thermal,
)
from fricmodels.rig.torques import (
    Asymmetry,
    Cogging,
    DirectionalEfficiency,
    Gravity,
    InertiaError,
    LoadFriction,
    NonlinearViscous,
    PositionFriction,
    Stiffness,
    Stribeck,
    TorqueGain,
    TorqueOffset,
    TorqueRipple,
)

AnyEffect = Annotated[
    Asymmetry
    | TorqueOffset
    | Stribeck
    | NonlinearViscous
    | LoadFriction
    | DirectionalEfficiency
    | TorqueGain
    | InertiaError
    | Gravity
    | Stiffness
    | Cogging
    | PositionFriction
    | TorqueRipple
    | Presliding
    | FrictionalLag
    | RisingStiction
    | Backlash
    | JointCompliance
    | SensorDelay
    | Thermal
    | Drift
    | StepChange,
    Field(discriminator="name"),
]
"""Any hidden effect, chosen by its name."""
