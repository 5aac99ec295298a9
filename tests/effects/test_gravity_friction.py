"""Friction of the load that gravity is: named beside gravity, with its zero, where no load is recorded."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import diagnose, improve
from fricmodels.recording import Recording
from fricmodels.rig import Rig

INERTIA, LOSS, ANGLE, WEIGHT = 1.2, 0.12, 0.4, 25.0


def joint(loss: float, seed: int = 3) -> Recording:
    """Return a rig's robot joint that carries a weight A sin(q − φ), of which friction takes a share."""
    rig = {
        "motion": "rotary",
        "inertia": INERTIA,
        "friction": {"coulomb": 6.0, "viscous": 3.0},
        "excitation": {"kind": "trapezoid", "velocity": 1.2, "acceleration": 3.0, "span": 3.0, "bandwidth": 4.0},
        "sensors": {"velocity_noise_percent": 0.3},
        "rate": 200.0,
        "samples": 8000,
        "seed": seed,
        "effects": [
            {
                "name": "gravity",
                "sine": WEIGHT * float(np.cos(ANGLE)),
                "cosine": -WEIGHT * float(np.sin(ANGLE)),
                "loss": loss,
            }
        ],
    }
    return Rig.model_validate(rig).simulate()


def test_it_is_named_with_its_share_and_the_zero_of_gravity() -> None:
    ladder = improve(joint(LOSS), "coulomb-viscous", INERTIA)
    last = ladder.rungs[-1].comparison
    assert [e.name for e in last.drive.model.effects] == ["gravity", "gravity-friction"]
    values, errors = last.estimate.parameters, last.estimate.standard_errors
    weight = np.hypot(values["gravity.a"], values["gravity.b"])
    assert values["gravity-friction.c"] / weight == pytest.approx(LOSS, abs=0.01)
    assert values["gravity-friction.phi"] == pytest.approx(ANGLE, abs=max(0.05, 3 * errors["gravity-friction.phi"]))
    assert ladder.last.verdict == "adequate"


@pytest.mark.long
def test_without_a_loss_gravity_is_all() -> None:
    ladder = improve(joint(0.0), "coulomb-viscous", INERTIA)
    assert [e.name for e in ladder.rungs[-1].comparison.drive.model.effects] == ["gravity"]


@pytest.mark.long
def test_it_is_considered_beside_gravity_only() -> None:
    recording = joint(LOSS)
    first = diagnose(recording, "coulomb-viscous", INERTIA).result
    beside = diagnose(recording, "coulomb-viscous+gravity", INERTIA).result
    assert first is not None
    assert beside is not None
    assert first.untested["gravity-friction"] == "it is considered beside gravity only"
    assert "gravity-friction" in [t.name for t in beside.tested]


def test_a_linear_axis_carries_no_weight_round() -> None:
    rig = {
        "motion": "linear",
        "inertia": 10.0,
        "friction": {"coulomb": 6.0, "viscous": 3.0},
        "excitation": {"kind": "sine", "amplitude": 30.0, "frequency": 0.5},
        "rate": 200.0,
        "samples": 2000,
    }
    result = diagnose(Rig.model_validate(rig).simulate(), "coulomb-viscous", 10.0).result
    assert result is not None
    assert result.untested["gravity-friction"] == "a linear axis does not turn"
