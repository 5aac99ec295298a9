"""The p-values of the candidates, corrected for how many there are."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import INERTIA, LAW, Made

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.candidate_tests import candidate_tests, is_taken_up
from fricmodels.diagnosis.policy import POLICY
from fricmodels.weakform.regression import LEAST_P


def test_p_values_are_corrected_for_the_number_of_effects_under_any_dependence(made: Made) -> None:
    """The adjusted i-th smallest of n is the least of p_j n (1 + 1/2 + … + 1/n) / j over j ≥ i, and at most 1."""
    recording = made("coulomb-viscous+stribeck", {"stribeck.F_s": 1.0, "stribeck.omega_s": 1.0, "stribeck.delta": 1.0})
    comparison = compare(recording, "coulomb-viscous", INERTIA)
    only = {"cogging", "stribeck", "torque-offset", "gravity", "asymmetry"}
    tested = sorted(
        candidate_tests(comparison.problem, comparison.estimate.parameters, only=only).tested, key=lambda t: t.p_value
    )
    count = len(tested)
    assert count >= 4
    harmonic = sum(1 / i for i in range(1, count + 1))
    raised = [t.p_value * count * harmonic / i for i, t in enumerate(tested, start=1)]
    expected = [max(LEAST_P, min(1.0, *raised[i:])) for i in range(count)]
    np.testing.assert_allclose([t.adjusted for t in tested], expected, rtol=1e-12)
    assert tested[0].adjusted > tested[0].p_value


def test_without_a_candidate_there_is_nothing_to_correct(made: Made) -> None:
    comparison = compare(made(), "coulomb-viscous", INERTIA)
    assert candidate_tests(comparison.problem, comparison.estimate.parameters, only=set()).tested == ()
    assert comparison.estimate.parameters["K_c"] == pytest.approx(LAW["K_c"], rel=0.05)


def test_with_an_estimated_inertia_and_no_load_no_torque_has_a_known_scale(made: Made) -> None:
    """Torque and everything that moves may be scaled together: neither gain nor inertia error is seen, nor guessed."""
    recording = made("coulomb-viscous")
    two = {"torque-gain", "inertia-error", "torque-ripple"}
    free, known = compare(recording, "coulomb-viscous"), compare(recording, "coulomb-viscous", INERTIA)
    estimated = candidate_tests(free.problem, free.estimate.parameters, only=two)
    given = candidate_tests(known.problem, known.estimate.parameters, only=two)
    assert set(estimated.untested) == {"torque-gain", "inertia-error"}
    assert not {"torque-gain", "inertia-error"} & set(given.untested)


def test_a_square_of_the_acceleration_is_told_from_an_estimated_inertia(made: Made) -> None:
    """What goes with the acceleration in another way than in proportion is not taken up by the inertia."""
    comparison = compare(made("coulomb-viscous"), "coulomb-viscous")
    problem = comparison.problem
    regression = candidate_tests(problem, comparison.estimate.parameters, only=set()).regression
    acceleration = problem.quadrature.recording["acceleration"]
    assert is_taken_up(problem, regression, problem.integrals(acceleration[None]))
    assert not is_taken_up(problem, regression, problem.integrals(np.abs(acceleration)[None]))


def test_nothing_is_sought_that_explains_less_than_sampling_leaves(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    comparison = compare(made(), "coulomb-viscous", INERTIA)
    problem, parameters = comparison.problem, comparison.estimate.parameters
    rivals: list[float] = []

    def asked(of: object, regression: object, effect: object, alone: object, rival: float) -> None:
        rivals.append(rival / float(problem.driving @ problem.driving))

    monkeypatch.setattr("fricmodels.diagnosis.candidate_tests.searched", asked)
    for policy in (POLICY, POLICY.without("sampling_leaves")):
        candidate_tests(problem, parameters, only=["backlash"], policy=policy)
    assert rivals == pytest.approx([POLICY.sampling_leaves**2, 0.0])
