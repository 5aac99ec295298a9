"""A joint that is quick to simulate, and models with its true numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.rig import Rig

LAW = {"K_v": 1.0, "K_c": 8.0}


@pytest.fixture(scope="session")
def joint() -> Callable[..., Rig]:
    """``joint(effects=[…])`` returns a rig of inertia 1 with Coulomb and viscous friction."""

    def build(**more: Any) -> Rig:
        return Rig.model_validate(
            {
                "name": "joint",
                "inertia": 1.0,
                "friction": {"viscous": LAW["K_v"], "coulomb": LAW["K_c"]},
                "excitation": {"kind": "tracking", "velocity": 1.0, "frequency": 0.5, "lines": 3, "bandwidth": 8.0},
                "rate": 500,
                "samples": 4000,
                **more,
            }
        )

    return build


@pytest.fixture(scope="session")
def drive() -> Drive:
    return Drive(Model.parse("coulomb-viscous"), 1.0)
