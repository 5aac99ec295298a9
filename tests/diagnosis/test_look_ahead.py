"""Several causes of which none shows, or helps, by itself."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import Ladder, compare, diagnose, improve
from fricmodels.diagnosis.candidate_tests import candidate_tests, corrected
from fricmodels.diagnosis.effect_set import Rest, nothing
from fricmodels.diagnosis.look_ahead import set_ahead, set_beside
from fricmodels.diagnosis.sought_functions import stretch
from fricmodels.diagnosis.verdict import select_effect
from fricmodels.recording import Recording

WAVE = {"position-friction.a": 1.0, "position-friction.b": 0.5, "position-friction.k": 3.3}
GRAVITY = {"gravity.a": 1.2, "gravity.b": 0.6}


@pytest.fixture(scope="module")
def short(made: Made) -> Recording:
    """Return a short record of a drive with three causes."""
    values = {**GRAVITY, **WAVE, "torque-offset.tau_0": 1.0}
    return made("coulomb-viscous+gravity+position-friction+torque-offset", values, samples=1200, rate=100.0)


@pytest.fixture(scope="module")
def ladder(short: Recording) -> Ladder:
    return improve(short, "coulomb-viscous", INERTIA)


@pytest.mark.long
def test_effects_that_show_only_beside_each_other_are_found(short: Recording, ladder: Ladder) -> None:
    """Each alone is tested against a residual that holds the other two."""
    comparison = compare(short, "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters)
    assert select_effect(result) is None
    names = {member.effect.name for member in set_ahead(result, set())}
    assert names == {"gravity", "position-friction", "torque-offset"}
    diagnosis = ladder.first
    assert diagnosis.judgement is not None
    assert diagnosis.judgement.only_jointly
    assert {finding.tested.name for finding in diagnosis.findings} == names


@pytest.mark.long
def test_a_ladder_has_them_all(ladder: Ladder) -> None:
    assert {rung.added for rung in ladder.rungs[1:]} == {"gravity", "position-friction", "torque-offset"}
    before, after = (ladder.rungs[i].comparison.errors.held_out_percent for i in (0, -1))
    assert after < 0.3 * before


def test_effects_that_help_only_together_are_named_together(made: Made) -> None:
    """The test error rises with each of them, and falls with all three: the blocks kept back see the others."""
    values = {**GRAVITY, "asymmetry.c": 1.0, "asymmetry.d": 0.5, "drift.a": 1.5, "drift.T": 2.0}
    recording = made("coulomb-viscous+gravity+asymmetry+drift", values, samples=800, rate=100.0)
    diagnosis = diagnose(recording, "coulomb-viscous", INERTIA)
    assert {finding.names[0] for finding in diagnosis.findings} == {"gravity", "asymmetry", "drift"}
    refits = diagnosis.refits
    assert refits is not None
    assert not any(refits.lowers_test_error(finding.tested) for finding in diagnosis.findings)


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_nothing_is_ahead_of_a_clean_drive(made: Made, seed: int) -> None:
    comparison = compare(made(noise=1.0, samples=1200, rate=100.0, seed=seed), "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters)
    assert set_ahead(result, set()) == []


def test_p_values_are_corrected_as_holm_says() -> None:
    """The example of Holm (1979) by hand: the least of three counts three times, and no later one less than it."""
    assert corrected([0.04, 0.01, 0.03]) == pytest.approx([0.06, 0.03, 0.06])
    assert corrected([0.5, 0.6]) == pytest.approx([1.0, 1.0])
    assert len(corrected([])) == 0


def test_an_effect_beside_a_zone_is_sought_beside_the_zone(made: Made) -> None:
    """A wave stands for a zone of friction; without it, and beside the zone, the spring alone is left."""
    recording = made("coulomb-viscous+stiffness", {"stiffness.k": 0.3})
    inside = (recording["position"] > 0.0) & (recording["position"] < 1.0)
    zone = 2.0 * np.sign(recording.velocity) * inside
    comparison = compare(recording.with_channels(torque=recording.torque + zone), "coulomb-viscous", INERTIA)
    result = candidate_tests(comparison.problem, comparison.estimate.parameters)
    mimics = {"position-friction", "torque-ripple"}
    rest = Rest((stretch(result.problem, result.regression, along=True),), nothing(result))
    assert [member.effect.name for member in set_beside(result, mimics, rest)] == ["stiffness"]
    assert set_beside(result, mimics, Rest((), nothing(result))) == []
