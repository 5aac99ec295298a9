"""A diagnosis does not depend on the last digits of a sample: it is the same after a change of 1e-9 of every one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, diagnose
from fricmodels.recording import Recording
from fricmodels.rig import Rig, random_rig
from fricmodels.signals import resting

CHANGE = 1e-9
SAMPLES = 4_000
HIDDEN = ("", "presliding", "rising-stiction", "step-change")


def changed(recording: Recording, change: float) -> Recording:
    """Return a recording with every sample but its time changed, relative."""
    rng = np.random.default_rng(1)
    other = {
        name: values if name == "time" else values * (1 + change * rng.uniform(-1, 1, len(values)))
        for name, values in recording.channels.items()
    }
    return replace(recording, channels=other)


def numbers(diagnosis: Diagnosis) -> dict[str, float]:
    """Return what is printed, by name."""
    comparison = diagnosis.comparison
    errors = comparison.errors
    found = {"percent": errors.percent, "held out": errors.held_out_percent, **comparison.estimate.parameters}
    for finding in diagnosis.findings:
        found |= finding.tested.parameters
        found["explained"] = finding.tested.evidence.explained
    return found


@pytest.mark.parametrize("effect", HIDDEN)
def test_a_diagnosis_is_the_same_where_the_last_digits_are_others(effect: str) -> None:
    rig = random_rig(np.random.default_rng(4), [effect] if effect else [])
    recording = rig.model_copy(update={"samples": SAMPLES}).simulate()
    first, other = (diagnose(changed(recording, c), rig.friction.law, rig.inertia) for c in (0.0, CHANGE))
    assert first.verdict == other.verdict
    assert [finding.names for finding in first.findings] == [finding.names for finding in other.findings]
    assert numbers(other) == pytest.approx(numbers(first), rel=1e-3, abs=1e-9)


def test_rest_is_found_on_a_drive_that_also_creeps_at_constant_speed() -> None:
    """At constant low speed the acceleration is zero but for rounding; no passage through zero takes for ever."""
    rig = Rig.model_validate(
        {
            "inertia": 2.0,
            "friction": {"viscous": 10.0, "coulomb": 10.0},
            "excitation": {
                "kind": "trapezoid",
                "velocity": 1.0,
                "acceleration": 8.0,
                "span": 0.6,
                "rests": [0.1, 0.8],
                "slowest": 0.4,
                "bandwidth": 30.0,
                "damping_ratio": 0.97,
            },
            "sensors": {"position": True},
            "rest_speed": 1e-4,
            "rate": 1000,
            "samples": 10_000,
            "seed": 3,
        }
    )
    recording = rig.simulate()
    speed = np.abs(recording.velocity)
    still, moving = speed < 1e-9, speed > 0.01
    assert still.sum() > 1000
    for change in (0.0, CHANGE):
        found = resting(changed(recording, change))
        assert found[still].mean() > 0.8
        assert found[moving].mean() < 1e-3
