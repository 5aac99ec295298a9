"""Where only a combination of parameters is determined: what the smaller model has stays what it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.conftest import INERTIA as MADE_WITH
from tests.conftest import Made

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform import solve
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.identification import _last_of_a_combination
from fricmodels.weakform.prepared import ready

INERTIA, VISCOUS, COULOMB, OFFSET, JUMP = 2.0, 0.5, 3.0, 0.4, 0.3
STRIBECK, STRIBECK_SPEED = 2.0, 0.1


def one_stroke_either_way(jump: float) -> Recording:
    """Return a drive that goes forward once and back once; the Coulomb torque jumps on the way forward."""
    time = 1e-3 * np.arange(8000)
    velocity = 6.0 * np.sin(2 * np.pi * time / 8.0) * (1 + 0.2 * np.cos(2 * np.pi * time / 0.9))
    rate = np.gradient(velocity, time, edge_order=2)
    friction = VISCOUS * velocity + (COULOMB + jump * (time >= 2.0)) * np.sign(velocity) + OFFSET
    noise = np.random.default_rng(0).standard_normal(len(time))
    channels = {"time": time, "torque": INERTIA * rate + friction + 1e-4 * noise, "velocity": velocity}
    return Recording("strokes", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("jump", [JUMP, -JUMP])
def test_of_a_combination_the_last_member_is_held(jump: float) -> None:
    r"""With one direction before it :math:`(K_c, \tau_0, c, d)` and that plus λ (1, −1, −1, 1) are one model.

    With the least values of all four, as least squares give them, the Coulomb torque took part of the jump.
    """
    model = Model.parse("coulomb-viscous+torque-offset+step-change")
    start = {"step-change.t_0": 2.0}
    _, found = estimate(Drive(model, INERTIA), one_stroke_either_way(jump), start)
    values = found.parameters
    assert values["step-change.d"] == 0.0
    assert values["K_c"] == pytest.approx(COULOMB, rel=5e-3)
    assert values["torque-offset.tau_0"] == pytest.approx(OFFSET, abs=0.02)
    assert values["step-change.c"] == pytest.approx(jump, abs=0.02)
    for key in ("K_c", "torque-offset.tau_0", "step-change.c", "step-change.d"):
        assert "only a combination" in found.not_identified[key], key
    assert "held at 0" in found.not_identified["step-change.d"]


@pytest.mark.parametrize(
    ("members", "held"),
    [
        ({"K_c": 0.6, "torque-offset.tau_0": 0.8}, "torque-offset.tau_0"),
        ({"K_c": 0.6, "rising-stiction.F": 0.8}, "rising-stiction.F"),
        ({"rising-stiction.F": 0.6, "rising-stiction.T": 0.8}, ""),
        ({"rising-stiction.T": 1.0}, ""),
        ({"J": 0.6, "K_v": 0.8}, "K_v"),
    ],
)
def test_what_may_be_nothing_is_linear_and_trades_with_what_is(members: dict[str, float], held: str) -> None:
    """After short rests F / T is determined: with another T there is another F, but with F = 0 there is nothing."""
    drive = Drive(Model.parse("coulomb-viscous+torque-offset+rising-stiction"))
    directions = np.zeros((len(drive.keys), 1))
    for key, share in members.items():
        directions[drive.keys.index(key)] = share
    assert _last_of_a_combination(drive, directions, set(drive.keys)) == held
    turned = np.array([[0.6, 0.8], [-0.8, 0.6]])  # any two axes span the same plane
    other = np.zeros((len(drive.keys), 1))
    other[drive.keys.index("rising-stiction.x_s")] = 1.0
    assert _last_of_a_combination(drive, np.hstack([directions, other]) @ turned, set(drive.keys)) == held


def slow_stretches(seed: int) -> Recording:
    """Return a drive with a Stribeck friction that slows down every two seconds and turns every six."""
    rng, time = np.random.default_rng(seed), np.arange(2500) / 200.0
    speed = 0.55 + 0.5 * np.sin(np.pi * time) * (1 + 0.1 * np.cos(2 * np.pi * time / 3.7))
    velocity = speed * np.tanh(20 * np.sin(2 * np.pi * (time + 0.2) / 12))
    rate = np.gradient(velocity, time, edge_order=2)
    falling = STRIBECK * np.exp(-(np.abs(velocity / STRIBECK_SPEED) ** 1.7))
    torque = INERTIA * rate + VISCOUS * velocity + (COULOMB + falling) * np.sign(velocity)
    channels = {
        "time": time,
        "torque": torque + rng.standard_normal(len(time)),
        "velocity": velocity + 0.03 * rng.standard_normal(len(time)),
    }
    return Recording("slow stretches", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.mark.parametrize("seed", range(4))
def test_what_the_rows_need_is_not_held_at_nothing_though_its_interval_contains_zero(seed: int) -> None:
    """F_s trades with its speed and exponent, whose values no torque needs where F_s is zero (Davies 1977).

    Held at zero it left so much more that K_v was three of its standard errors off, 0.06 to 0.22.
    """
    _, found = estimate(Drive(Model.parse("coulomb-viscous+stribeck"), INERTIA), slow_stretches(seed))
    _, plain = estimate(Drive(Model.parse("coulomb-viscous"), INERTIA), slow_stretches(seed))
    assert found.parameters["stribeck.F_s"] > 0.5
    assert abs(found.parameters["K_v"] - VISCOUS) < 2 * found.standard_errors["K_v"]
    assert abs(plain.parameters["K_v"] - VISCOUS) > 0.25
    assert found.residual_percent < 0.9 * plain.residual_percent


def test_what_far_more_is_left_without_is_not_held(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    """However wide its interval: a covariance of strokes that are much alike may be a hundred times too large."""
    law = "coulomb-viscous+nonlinear-viscous"
    recording = ready(made(law, {"nonlinear-viscous.b": 0.4}))
    expected = estimate(Drive(Model.parse(law), MADE_WITH), recording)[1]
    known = solve.covariance
    monkeypatch.setattr(solve, "covariance", lambda *given: 1e8 * known(*given))
    _, found = estimate(Drive(Model.parse(law), MADE_WITH), replace(recording))
    assert found.parameters["nonlinear-viscous.b"] == pytest.approx(expected.parameters["nonlinear-viscous.b"], rel=0.1)
    assert "contains zero" in found.not_identified["nonlinear-viscous.b"]
    assert found.residual_percent < 2.0 * expected.residual_percent
