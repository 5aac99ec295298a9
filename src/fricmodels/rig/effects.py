"""The effects that a simulated drive can hide, as ``effects:`` in a rig file lists them.

On a linear axis read N for N m and m for rad.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, get_args

from pydantic import Field

from fricmodels.rig.hidden import HiddenEffect
from fricmodels.rig.memory import MemoryEffect
from fricmodels.rig.torques import TorqueEffect

AnyEffect = Annotated[TorqueEffect | MemoryEffect, Field(discriminator="name")]
"""Any hidden effect, chosen by its name."""

HIDDEN: Mapping[str, type[HiddenEffect]] = {
    cls.model_fields["name"].default: cls for cls in (*get_args(TorqueEffect), *get_args(MemoryEffect))
}
"""Every hidden effect by its name."""
