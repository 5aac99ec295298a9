"""A wave over many turns, as of a gear's output seen from its motor, is cogging as any other."""

from __future__ import annotations

import pytest

from fricmodels.diagnosis import diagnose
from fricmodels.rig import Rig


@pytest.mark.parametrize("order", [0.2])
def test_a_wave_longer_than_a_turn_is_named_with_its_order(order: float) -> None:
    rig = Rig.model_validate(
        {
            "inertia": 0.01,
            "friction": {"viscous": 0.01, "coulomb": 0.5},
            "effects": [{"name": "cogging", "harmonics": [{"order": order, "amplitude": 0.15, "phase": 0.4}]}],
            "excitation": {
                "kind": "trapezoid",
                "velocity": 30.0,
                "acceleration": 300.0,
                "span": 60.0,
                "bandwidth": 30.0,
                "damping_ratio": 0.9,
            },
            "sensors": {"velocity_noise_percent": 0.5, "position": True},
            "rate": 500,
            "samples": 6000,
            "seed": 1,
        }
    )
    diagnosis = diagnose(rig.simulate(), "coulomb-viscous", 0.01)
    assert [finding.names for finding in diagnosis.findings] == [("cogging",)]
    assert diagnosis.findings[0].tested.parameters["k"] == pytest.approx(order, rel=0.01)
