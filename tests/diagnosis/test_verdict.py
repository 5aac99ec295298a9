"""From a recording to an answer: nothing, the effect, a class that cannot be told apart, or something unknown."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import pytest

from fricmodels.diagnosis import Diagnosis, diagnose
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.look_alikes import experiment, separated_by
from fricmodels.diagnosis.verdict import passing_all_gates, select_effect
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate

Made = Callable[..., Recording]
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


@pytest.mark.parametrize(("effect", "values"), HIDDEN, ids=[case[0] for case in HIDDEN])
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


def test_a_constant_that_is_no_stiffness_is_an_offset_or_an_asymmetry(diagnosed: Callable[..., Diagnosis]) -> None:
    """While sliding the two are the same torque; a spring contains a constant too, but adds nothing of its own."""
    found = diagnosed("torque-offset", (("tau_0", 0.5),))
    assert found.verdict == "undecided"
    assert {"torque-offset", "asymmetry"} <= set(found.findings[0].names)
    assert "stiffness" not in found.findings[0].names
    assert "at rest" in found.findings[0].separated_by


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
    assert {t.name for t in result.tested} | set(result.unseen) == {"drift"}


def test_every_pair_has_an_experiment_that_would_tell() -> None:
    names = list(load().effects)
    for first in names:
        for second in names:
            if first != second:
                assert experiment(first, second) == experiment(second, first) != "" or "vary independently" in (
                    experiment(first, second)
                )
    assert separated_by(["cogging"]) == ""
    assert separated_by(["asymmetry", "torque-offset"]).startswith("a static test")
    assert separated_by(["thermal", "drift"]).count("thermometer") == 1
