"""From a recording to an answer: nothing, the effect, a class that cannot be told apart, or something unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import combinations
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, diagnose, improve, look_alikes
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.look_alikes import experiment, separated_by
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.verdict import passing_all_gates, predicts, select_effect
from fricmodels.drive import Drive
from fricmodels.effects.gravity import Gravity
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate

Made = Callable[..., Recording]
LAW = Model.parse("coulomb-viscous")
COGGING = {"cogging.a": 0.5, "cogging.b": 0.0, "cogging.k": 7.3}


@pytest.fixture(scope="module")
def diagnosed(made: Made) -> Callable[..., Diagnosis]:
    @lru_cache(maxsize=16)
    def build(effect: str = "", values: tuple[tuple[str, float], ...] = (), leave_out: str = "") -> Diagnosis:
        name = f"coulomb-viscous+{effect}" if effect else "coulomb-viscous"
        recording = made(name, {f"{effect}.{key}": value for key, value in values})
        return diagnose(recording, Model.parse("coulomb-viscous"), 2.0, leave_out=[leave_out] if leave_out else [])

    return build


def test_a_complete_model_is_adequate(diagnosed: Callable[..., Diagnosis]) -> None:
    found = diagnosed()
    assert (found.verdict, found.findings, found.view) == ("adequate", (), None)
    assert set(found.visibility) == set(load().effects)


HIDDEN: list[tuple[str, tuple[tuple[str, float], ...]]] = [
    ("cogging", (("a", 0.5), ("b", 0.0), ("k", 7.3))),
    ("step-change", (("c", 0.6), ("d", 0.0), ("t_0", 6.3))),
    ("presliding", (("F_1", 3.0), ("F_2", 3.0), ("D", 0.0), ("x_s", 0.05))),
    ("position-friction", (("a", 0.5), ("b", 0.2), ("k", 2.6))),
    ("gravity", (("a", 1.0), ("b", 0.5))),
    ("stiffness", (("k", 0.5), ("tau_0", 0.0))),
    ("drift", (("a", 0.02), ("b", 0.05))),
]


EVERY_DAY = ("presliding",)
"""The others are named on the rig, a drift in test_supported.py."""


@pytest.mark.parametrize(
    ("effect", "values"),
    [pytest.param(*case, id=case[0], marks=() if case[0] in EVERY_DAY else pytest.mark.long) for case in HIDDEN],
)
def test_the_hidden_effect_is_named_first(
    diagnosed: Callable[..., Diagnosis], effect: str, values: tuple[tuple[str, float], ...]
) -> None:
    found = diagnosed(effect, values)
    assert found.verdict in ("missing-effect", "undecided")
    first = found.findings[0]
    assert first.names[0] == effect
    assert bool(first.separated_by) == (len(first.names) > 1)
    assert first.tested.adjusted < 0.01
    assert 0 < first.tested.evidence.gain < 1
    assert effect not in found.visibility


@pytest.mark.long
def test_a_constant_that_is_no_stiffness_is_an_offset_or_an_asymmetry(diagnosed: Callable[..., Diagnosis]) -> None:
    """While sliding the two are the same torque; a spring contains a constant too, but adds nothing of its own."""
    found = diagnosed("torque-offset", (("tau_0", 0.5),))
    assert found.verdict == "undecided"
    assert {"torque-offset", "asymmetry"} <= set(found.findings[0].names)
    assert "stiffness" not in found.findings[0].names
    assert "at rest" in found.findings[0].separated_by


@pytest.mark.long
def test_what_no_candidate_explains_is_unknown_and_the_channel_is_named(made: Made) -> None:
    leave_out = ["cogging", "gravity", "stiffness", "position-friction", "torque-ripple"]
    recording = made("coulomb-viscous+gravity", {"gravity.a": 1.0, "gravity.b": 0.5})
    found = diagnose(recording, Model.parse("coulomb-viscous"), 2.0, leave_out=leave_out)
    assert (found.verdict, found.findings) == ("unknown-effect", ())
    assert found.view is not None
    assert found.view.channels == "position"


def test_an_effect_without_its_channel_could_not_have_been_seen(diagnosed: Callable[..., Diagnosis]) -> None:
    seen = diagnosed().visibility
    assert "no temperature" in seen["thermal"].missing
    assert "no load torque" in seen["load-friction"].missing
    assert np.isnan(seen["thermal"].smallest_percent)
    assert seen["cogging"].missing == ""
    assert seen["cogging"].smallest_percent > 0


@pytest.mark.long
def test_effects_above_the_smallest_visible_size_are_found_and_far_below_it_not(
    made: Made, diagnosed: Callable[..., Diagnosis]
) -> None:
    smallest = diagnosed().visibility["gravity"].smallest_torque * np.sqrt(2)
    for factor, expected in ((4.0, True), (0.1, False)):
        values = {"gravity.a": factor * smallest, "gravity.b": 0.0}
        found = diagnose(made("coulomb-viscous+gravity", values), Model.parse("coulomb-viscous"), 2.0)
        named = {name for finding in found.findings for name in finding.names}
        assert ("gravity" in named) == expected, factor


def test_the_answer_passes_the_gates_and_is_the_best_of_those_that_do(made: Made) -> None:
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), made("coulomb-viscous+cogging", COGGING))
    result = candidate_tests(problem, found.parameters, only=["cogging", "gravity", "drift", "stiffness"])
    best = select_effect(result)
    assert best is not None
    assert best.first.name == "cogging"
    assert best.first in passing_all_gates(result)
    losses = [float(np.sum(t.evidence.loss)) for t in result.tested]
    assert losses == sorted(losses)
    assert all(t.adjusted >= t.p_value for t in result.tested)


def test_what_is_in_the_model_or_left_out_is_not_tested(made: Made) -> None:
    drive = Drive(Model.parse("coulomb-viscous+gravity"), 2.0)
    problem, found = estimate(drive, made(samples=4000))
    result = candidate_tests(problem, found.parameters, leave_out=["cogging"], only=["gravity", "cogging", "drift"])
    assert {t.name for t in result.tested} | set(result.untested) == {"drift"}


def test_every_effect_declares_its_look_alikes_by_registered_names_and_once() -> None:
    effects = load().effects
    pairs = [frozenset({name, other}) for name in effects for other in effects[name].separated_from]
    assert all(len(pair) == 2 and pair <= set(effects) for pair in pairs)
    assert len(set(pairs)) == len(pairs)
    assert {name for pair in pairs for name in pair} == set(effects)


@pytest.mark.parametrize(
    ("class_", "told_by"),
    [
        (["cogging"], ""),
        (["torque-offset", "asymmetry"], "a static test"),
        (["thermal", "drift", "step-change"], "a run that begins warm"),
        (["thermal", "drift"], "a run that begins warm"),
        (["drift", "step-change"], "a new record of the same motion"),
        (["gravity", "stiffness", "cogging"], "a wider position range"),
        (["cogging", "position-friction"], "pass the same positions in both directions"),
        (["inertia-error", "sensor-delay", "torque-gain", "joint-compliance"], "several frequencies"),
        (["directional-efficiency", "torque-offset", "asymmetry"], "another load"),
        (["gravity", "torque-gain"], "another payload"),
        (["thermal", "cogging"], "a record that warms and cools again"),
        (["sensor-delay", "backlash"], "small reversals"),
        (["drift", "gravity"], "a new record of the same motion"),
        (["cogging", "stribeck"], "the same motion about another position"),
        (["cogging", "gravity-friction"], "pass the same positions in both directions"),
        (["other(j2_velocity)", "other-friction(j2_velocity)"], "the other joint moved alone"),
        (["other(j2)", "other(j3)"], "the other joints moved one at a time"),
    ],
)
def test_a_class_of_look_alikes_names_the_experiments_that_would_tell(class_: list[str], told_by: str) -> None:
    text = separated_by(class_)
    assert text.startswith(told_by)
    assert text.count(";") <= 2, "one experiment each is enough"
    assert bool(text) == (len(class_) > 1)
    for first, second in combinations(class_, 2):
        assert experiment(first, second) == experiment(second, first)


def test_no_experiment_asks_for_a_sensor_that_an_effect_of_the_class_needs() -> None:
    """Where a temperature was recorded there is a thermometer; only then is friction that goes with it considered."""
    for others in (["drift"], ["step-change"], ["drift", "step-change"]):
        assert "thermometer" not in separated_by(["thermal", *others])
    assert "thermometer" not in separated_by(["drift", "step-change"])  # it may be there, and tells them not


def test_every_two_effects_have_an_experiment_that_names_something_to_do() -> None:
    names = [
        name if name.partition("-")[0] not in ("other", "proximal", "chain") else f"{name}(j2)"
        for name in load().effects
    ]
    for first, second in combinations(names, 2):
        text = experiment(first, second)
        assert text
        assert f"'{first}'" not in text
        assert "independently" not in text


def test_an_effect_of_a_plugin_declares_its_own_experiment(monkeypatch: pytest.MonkeyPatch) -> None:
    class Squeal(Gravity):
        name = "squeal"
        separated_from: ClassVar[Mapping[str, str]] = {"cogging": "a microphone"}

    known = load()
    effects = {**{name: known.effects[name] for name in known.effects}, "squeal": Squeal}
    monkeypatch.setattr(look_alikes.plugins, "load", lambda: SimpleNamespace(effects=effects))
    assert separated_by(["cogging", "squeal"]) == separated_by(["squeal", "cogging"]) == "a microphone"


def test_an_effect_within_another_is_a_look_alike_only_where_it_is_another_cause(made: Made) -> None:
    """While sliding an offset is an asymmetry, another cause; it is also a spring of no stiffness, which is none."""
    problem, found = estimate(Drive(LAW, 2.0), made("coulomb-viscous+torque-offset", {"torque-offset.tau_0": 0.5}))
    result = candidate_tests(problem, found.parameters, only=["torque-offset", "asymmetry", "stiffness"])
    named = select_effect(result)
    assert named is not None
    assert set(named.names) == {"torque-offset", "asymmetry"}
    every = select_effect(replace(result, policy=POLICY.without("contained")))
    assert every is not None
    assert "stiffness" in every.names


def test_a_rival_is_tested_at_the_level_of_the_effect(made: Made) -> None:
    """Where few events hold the gain of an effect and of a channel, both pass, or neither."""
    problem, found = estimate(Drive(LAW, 2.0), made("coulomb-viscous+cogging", COGGING))
    result = candidate_tests(problem, found.parameters, only=["cogging"])
    between = 0.5 * (POLICY.predictor_gain_significance + POLICY.effect_gain_significance)
    tested = next(t for t in result.tested if t.name == "cogging")
    doubtful = replace(tested, evidence=replace(tested.evidence, gain_p_value=between))
    assert doubtful.name in {t.name for t in passing_all_gates(replace(result, tested=(doubtful,)))}
    assert not predicts(result, doubtful.evidence, doubtful.adjusted)
    assert predicts(result, doubtful.evidence, doubtful.adjusted, as_rival=True)


def test_which_of_two_it_is_is_one_question_and_not_one_of_many(made: Made) -> None:
    """A jump that a drift resembles: the drift passes, and the jump, which explains more, only but for the others."""
    values = {"step-change.c": 0.6, "step-change.d": 0.0, "step-change.t_0": 6.3}
    problem, found = estimate(Drive(LAW, 2.0), made("coulomb-viscous+step-change", values))
    result = candidate_tests(problem, found.parameters, only=["step-change", "drift"])
    jump, drift = (next(t for t in result.tested if t.name == name) for name in ("step-change", "drift"))
    for by_itself, names in ((0.5 * POLICY.significance, ["drift", "step-change"]), (0.5, ["drift"])):
        doubtful = replace(jump, p_value=by_itself, adjusted=max(by_itself, 2 * POLICY.significance))
        best = select_effect(replace(result, tested=(doubtful, drift)))
        assert best is not None
        assert best.names == names
    unlikely = replace(drift, p_value=0.5 * POLICY.significance, adjusted=2 * POLICY.significance)
    best = select_effect(replace(result, tested=(jump, unlikely)))
    assert best is not None
    assert best.names == ["step-change"]


def test_what_is_certain_beneath_loud_noise_is_an_effect(made: Made) -> None:
    """An offset that takes a hundredth of rows that are nearly all noise; a channel that does as little is no cause."""
    recording = made("coulomb-viscous+torque-offset", {"torque-offset.tau_0": 0.3}, noise=10.0)
    problem, found = estimate(Drive(LAW, 2.0), recording)
    result = candidate_tests(problem, found.parameters, only=["torque-offset"])
    (offset,) = passing_all_gates(result)
    assert 0.0 < offset.evidence.gain < POLICY.least_gain
    assert predicts(result, offset.evidence, offset.adjusted, as_rival=True)
    assert not predicts(result, offset.evidence, offset.adjusted)


@pytest.mark.parametrize("function", [diagnose, improve])
@pytest.mark.parametrize(
    ("named", "said"),
    [(["coging"], "did you mean 'cogging'"), ("cogging", "leave_out takes several names, got 'cogging'")],
)
def test_an_effect_to_be_left_out_must_be_one(
    made: Made, function: Callable[..., object], named: object, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        function(made(samples=500), "coulomb-viscous", 2.0, leave_out=named)
