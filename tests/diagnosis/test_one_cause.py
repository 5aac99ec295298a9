"""Whether several effects only imitate one unknown cause together: what a channel is decides."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import compare, diagnose, effect_set, one_cause
from fricmodels.diagnosis.basis_functions import FINELY
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.effect_set import Member, member_of, the_past_counts
from fricmodels.diagnosis.one_cause import _are_slow_waves
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.predictability import ChannelPredictor
from fricmodels.diagnosis.verdict import LookAlikes
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.effects.cogging import Cogging
from fricmodels.model import Model
from fricmodels.recording import Recording

WAVES = {
    "position-friction.a": 0.3,
    "position-friction.b": 0.2,
    "position-friction.k": 7.0,
    "cogging.a": 0.3,
    "cogging.b": -0.2,
    "cogging.k": 2.6,
}


@pytest.mark.parametrize(
    ("channels", "names"), [("position", {"cogging", "position-friction"}), ("speed", set()), (FINELY, set())]
)
def test_several_waves_that_were_sought_are_no_one_cause_of_several_waves(
    made: Made, monkeypatch: pytest.MonkeyPatch, channels: str, names: set[str]
) -> None:
    """A channel that can be all that two waves are takes their place, unless it is such waves itself."""
    comparison = compare(made("coulomb-viscous+position-friction+cogging", WAVES), "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=["cogging", "position-friction"])
    members: list[Member] = [member_of(result, LookAlikes(t, (t,))) for t in result.tested]
    columns = np.vstack([m.columns for m in members])
    if channels == "speed":  # a channel that does nothing of it
        speed = np.abs(comparison.problem.quadrature.recording.velocity)
        columns = comparison.problem.integrals(speed[None])
    predictor = ChannelPredictor(channels, result.regression.test(columns), 1e-20, columns, 20)
    monkeypatch.setattr(one_cause, "passing_beside", lambda *_, **__: [predictor])
    found = one_cause.that_are_one_cause(result, members, members)
    assert {m.found.first.name for m in found} == names


@pytest.mark.parametrize(
    ("memory", "left", "counts"), [(True, 30.0, True), (True, 3.0, False), (False, 30.0, False), (False, 3.0, False)]
)
def test_the_past_of_a_torque_counts_against_what_has_memory_and_leaves_something(
    made: Made, monkeypatch: pytest.MonkeyPatch, memory: bool, left: float, counts: bool
) -> None:
    """Of 100 above noise 30 are something, and 3 are no gain that counts."""
    problem = compare(made(), "coulomb-viscous", INERTIA).problem
    result: Any = SimpleNamespace(problem=problem, policy=POLICY)
    member: Any = SimpleNamespace(effect=SimpleNamespace(states=("z",) if memory else ()))
    gain = SimpleNamespace(before=1e6, fall=1e6 * (1 - left / 100))
    monkeypatch.setattr(effect_set, "gain_of", lambda *_: gain)
    assert the_past_counts(result, member, np.zeros((0, 1))) is counts


@pytest.mark.parametrize("terms", [4, 2])
def test_an_effect_that_does_all_of_it_needs_no_other(made: Made, monkeypatch: pytest.MonkeyPatch, terms: int) -> None:
    """A spring and a small wave: terms that hold the spring too, and are no fewer than its own, are no simpler form."""
    values = {"stiffness.k": 1.0, "cogging.a": 0.1, "cogging.k": 2.6}
    comparison = compare(made("coulomb-viscous+stiffness+cogging", values), "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=["cogging", "stiffness"])
    members = {t.name: member_of(result, LookAlikes(t, (t,))) for t in result.tested}
    spring, wave = members["stiffness"].columns, members["cogging"].columns[:2]
    columns = np.vstack([spring, wave]) if terms == 4 else spring + 0.1 * wave
    predictor = ChannelPredictor("position", result.regression.test(columns), 1e-20, columns, 20)
    monkeypatch.setattr(one_cause, "passing_beside", lambda *_, **__: [predictor])
    found = one_cause.that_are_one_cause(result, list(members.values()), list(members.values()))
    assert [m.found.first.name for m in found] == ["cogging"]


@pytest.mark.parametrize(("of_model", "found", "series"), [(1.0, 2.7, True), (1.0, 9.0, False), (9.0, 25.0, False)])
def test_two_slow_waves_of_a_kind_are_a_shape(made: Made, of_model: float, found: float, series: bool) -> None:
    """Periods in the travel: a bump of a linear axis was five waves of 1.0 to 3.5, with amplitudes that cancel."""
    recording = made()
    unit = 2 * np.pi / float(np.ptp(recording["position"]))
    drive = Drive(Model.parse("coulomb-viscous+cogging"), 2.0)
    problem = SimpleNamespace(drive=drive, recording=recording)
    result: Any = SimpleNamespace(problem=problem, parameters={"cogging.k": of_model * unit}, policy=POLICY)
    tested = SimpleNamespace(found=SimpleNamespace(nonlinear=(found * unit,)))
    member: Any = SimpleNamespace(effect=Cogging(2), found=SimpleNamespace(first=tested))
    assert _are_slow_waves(result, [member]) is series
    result.policy = POLICY.without("wave_periods")
    assert not _are_slow_waves(result, [member])


@pytest.mark.parametrize(
    ("part", "much", "names"), [(0.7, 0.5, []), (1.0, 0.5, ["cogging", "stiffness"]), (1.0, 0.0, [])]
)
def test_a_channel_that_takes_more_terms_and_does_less_is_no_form_of_them(
    made: Made, monkeypatch: pytest.MonkeyPatch, part: float, much: float, names: list[str]
) -> None:
    """A spring and a wave of as much torque: a channel of many terms that holds both stands for them, or does not.

    Not where they leave nothing above noise; with half of what either explains beside them it does.
    """
    values = {"stiffness.k": 1.0, "cogging.a": 1.0, "cogging.k": 2.6}
    comparison = compare(made("coulomb-viscous+stiffness+cogging", values), "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=["cogging", "stiffness"])
    members = [member_of(result, LookAlikes(t, (t,))) for t in result.tested]
    rng = np.random.default_rng(0)
    own = np.vstack([m.columns for m in members])
    # Its first columns are those of the effects with as much of anything else as leaves a part of them.
    other = rng.standard_normal(own.shape) * np.std(own, axis=1, keepdims=True)
    columns = np.vstack([part * own + (1.0 - part) * other, rng.standard_normal((3, own.shape[1]))])
    predictor = ChannelPredictor("position", result.regression.test(columns), 1e-20, columns, 20)
    monkeypatch.setattr(one_cause, "passing_beside", lambda *_, **__: [predictor])
    monkeypatch.setattr(one_cause, "_takes_place", lambda *_: True)
    monkeypatch.setattr(one_cause, "predicts_beside", lambda *_, **__: True)
    least = min(one_cause.gain_of(result, one.columns, other).fall for one, other in (members, members[::-1]))
    monkeypatch.setattr(one_cause, "above_noise", lambda *_: much * least)
    found = one_cause.that_are_one_cause(result, members, members)
    assert sorted(m.found.first.name for m in found) == names


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 3])
def test_gravity_and_cogging_over_less_than_a_turn_are_two_causes(seed: int) -> None:
    """A channel of the position can be both, with more terms; they leave nothing above noise of what either explains.

    A joint on a Fourier series of 0.8 rad, as for an identification.
    """
    rng = np.random.default_rng(seed)
    time, rates = 0.002 * np.arange(10_000), 0.2 * np.pi * np.arange(1, 6)
    sines, cosines = rng.uniform(-1, 1, (2, 5)) / rates
    phase = rates[:, None] * time
    position = sines @ np.sin(phase) + cosines @ np.cos(phase)
    scale = 0.42 / np.max(np.abs(position - np.mean(position)))
    velocity = scale * ((sines * rates) @ np.cos(phase) - (cosines * rates) @ np.sin(phase))
    acceleration = -scale * ((sines * rates**2) @ np.sin(phase) + (cosines * rates**2) @ np.cos(phase))
    position *= scale
    friction = (3.0 + 0.9 * np.exp(-((velocity / 0.08) ** 2))) * np.sign(velocity) + 1.8 * velocity
    over_position = 1.476 * np.sin(position + 0.6) + 0.39 * np.sin(23.0 * position)
    channels = {
        "time": time,
        "torque": 0.2 * acceleration + friction + over_position + 0.025 * rng.standard_normal(len(time)),
        "velocity": velocity + 0.002 * rng.standard_normal(len(time)),
        "position": position,
    }
    recording = Recording("joint", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))
    found = diagnose(recording, "coulomb-viscous", 0.2)
    assert {"gravity", "cogging", "stribeck"} <= {name for finding in found.findings for name in finding.names}
