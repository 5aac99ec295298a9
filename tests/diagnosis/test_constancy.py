"""An effect that is there is the same throughout the motion; one that stands in for another cause is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import compare, improve
from fricmodels.diagnosis.constancy import changes
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report.answer import sure
from fricmodels.report.reliability import CHANGING
from fricmodels.simulation import simulate

J, RATE, SAMPLES = 0.02, 500.0, 15_000
TRUE = {"K_v": 0.01, "K_c": 0.1, "gravity.a": 0.0, "gravity.b": 0.2, "J": J}


def joint(more: float = 0.0, seed: int = 0, size: float = 1.0) -> Recording:
    """Return a joint with gravity that is so much larger, in units of itself, where the joint is fast."""
    rng = np.random.default_rng(seed)
    time = np.arange(SAMPLES) / RATE
    torque = sum(
        a * np.sin(2 * np.pi * f * time + rng.uniform(0, 6)) for a, f in ((0.5, 0.31), (0.45, 0.73), (0.35, 1.27))
    )
    moved = simulate(Drive(Model.parse("coulomb-viscous+gravity"), J), TRUE, time, torque, seed=seed)
    speed = np.abs(moved.velocity)
    fast = speed > np.median(speed[speed > 0.0])
    pushed = moved.torque + more * TRUE["gravity.b"] * np.sin(moved["position"]) * fast
    channels = {
        "time": time,
        "torque": size * (pushed + 0.005 * rng.standard_normal(SAMPLES)),
        "velocity": moved.velocity + 0.01 * rng.standard_normal(SAMPLES),
        "position": moved["position"],
    }
    return Recording("joint", Motion.ROTARY, channels, np.zeros(SAMPLES, dtype=np.int64))


@pytest.mark.long
def test_an_effect_that_is_there_is_the_same_throughout() -> None:
    said = [changes(compare(joint(seed=seed), "coulomb-viscous+gravity", J)) for seed in range(8)]
    assert not any(said)


def test_what_changes_is_found_with_its_size() -> None:
    comparison = compare(joint(more=1.0), "coulomb-viscous+gravity", J)
    (found,) = changes(comparison)
    assert (found.effect, found.half) == ("gravity", "at high speed")
    fitted = comparison.estimate.parameters["gravity.b"]
    assert abs(found.change * fitted - TRUE["gravity.b"]) < max(3.0 * found.standard_error * fitted, 0.1 * fitted)
    assert found.p_value < POLICY.constancy_significance
    assert "at high speed it is larger by" in found.text


def test_less_than_half_of_an_effect_is_not_said() -> None:
    assert not changes(compare(joint(more=0.3), "coulomb-viscous+gravity", J))


def test_units_change_nothing() -> None:
    small, large = (
        changes(compare(joint(more=1.0, size=size), "coulomb-viscous+gravity", size * J)) for size in (1.0, 1e3)
    )
    assert large[0].change == pytest.approx(small[0].change, rel=1e-6)
    assert large[0].half == small[0].half


@pytest.mark.long
def test_an_answer_with_such_an_effect_says_so() -> None:
    ladder = improve(joint(more=1.0), "coulomb-viscous", J)
    assert ladder.rungs[-1].model.startswith("coulomb-viscous+gravity")
    data = document(ladder.first, ladder)
    (said,) = [change for change in data.changes if change.effect == "gravity"]
    assert said.half == "at high speed"
    assert "But gravity is not the same throughout the motion: at high speed it is larger by" in sure(data)
    assert CHANGING.said in sure(data)
    quiet = improve(joint(more=1.0), "coulomb-viscous", J, policy=replace(POLICY, constancy_change=np.inf))
    assert document(quiet.first, quiet).changes == ()


def test_an_answer_without_one_does_not() -> None:
    ladder = improve(joint(), "coulomb-viscous", J)
    data = document(ladder.first, ladder)
    assert ladder.rungs[-1].model == "coulomb-viscous+gravity"
    assert data.changes == ()
    assert CHANGING.said not in sure(data)
