"""A friction takes energy from the drive: what makes of it one that drives is no part of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.diagnosis import Comparison, compare, improve
from fricmodels.diagnosis.candidate_tests import CandidateTest, candidate_tests
from fricmodels.diagnosis.document import comparison_document
from fricmodels.diagnosis.passive import drives_from, driving_share
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.refits import Refits
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.report.error_words import error_words

INERTIA, VISCOUS, COULOMB = 2.0, 0.4, 1.0


def record(difference: float, slope: float = 0.0, offset: float = 0.0, seed: int = 0) -> Recording:
    """Return a drive whose friction differs between the directions by ± a torque and ± a slope, with an offset."""
    rng, time = np.random.default_rng(seed), 0.002 * np.arange(8000)
    velocity = 2.0 * np.sin(1.9 * time) + 1.5 * np.sin(4.3 * time)
    rate = 3.8 * np.cos(1.9 * time) + 6.45 * np.cos(4.3 * time)
    friction = VISCOUS * velocity + COULOMB * np.sign(velocity) + difference + slope * np.abs(velocity) + offset
    torque = INERTIA * rate + friction + 0.05 * rng.standard_normal(len(time))
    channels = {"time": time, "torque": torque, "velocity": velocity + 1e-3 * rng.standard_normal(len(time))}
    return Recording("uneven", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


def asymmetry(recording: Recording) -> tuple[Comparison, CandidateTest]:
    """Return the symmetric model, and the test of an asymmetry on what it leaves."""
    comparison = compare(recording, "coulomb-viscous", INERTIA)
    parameters = comparison.estimate.parameters
    (tested,) = candidate_tests(replace(comparison.problem), parameters, only=["asymmetry"]).tested
    return comparison, tested


@pytest.mark.parametrize("c", [0.0, 0.8, 3.0, -3.0])
def test_the_share_of_the_motion_in_which_a_friction_drives(c: float) -> None:
    """With 1 N m one way and ± 3 N m more, 2 N m drive one way, and 4 N m brake the other."""
    comparison = compare(record(0.0), "coulomb-viscous+asymmetry", INERTIA)
    values = {**comparison.estimate.parameters, "K_v": 0.0, "K_c": 1.0, "asymmetry.c": c, "asymmetry.d": 0.0}
    given = replace(comparison, estimate=replace(comparison.estimate, parameters=values))
    velocity = comparison.problem.smooth[~comparison.problem.resting]
    expected = {3.0: np.mean(velocity < 0.0), -3.0: np.mean(velocity > 0.0)}
    assert driving_share(given, 0.01) == pytest.approx(float(expected.get(c, 0.0)), rel=1e-9)


@pytest.mark.parametrize(("error", "drives"), [(0.01, True), (0.05, False)])
def test_a_friction_drives_by_more_than_its_error_or_not_at_all(error: float, drives: bool) -> None:
    """0.1 N m that drive are 7 standard errors, or 1.4 of which 3.03 may be chance at 1 % with two parameters."""
    comparison = compare(record(0.0), "coulomb-viscous+asymmetry", INERTIA)
    values = {**comparison.estimate.parameters, "K_v": 0.0, "K_c": 1.0, "asymmetry.c": 1.1, "asymmetry.d": 0.0}
    keys = ["K_v", "K_c", "asymmetry.c", "asymmetry.d"]
    errors = dict(zip(keys, [0.0, error, error, 0.0], strict=True))
    covariance = np.diag(np.array(list(errors.values())) ** 2)
    found = replace(comparison.estimate, parameters=values, standard_errors=errors, covariance=covariance)
    assert (driving_share(replace(comparison, estimate=found), 0.01) > 0.3) is drives


def test_friction_that_drives_at_low_speed_only_is_refused() -> None:
    """A torque of |acceleration| on one sine is c − d |ω| with c above K_c: little work, but no friction."""
    rng, time = np.random.default_rng(3), 0.005 * np.arange(4000)
    velocity, rate = 2.0 * np.sin(2.1 * time), 4.2 * np.cos(2.1 * time)
    torque = INERTIA * rate + 0.3 * np.sign(velocity) + 0.1 * velocity + 0.15 * np.abs(rate)
    channels = {"time": time, "torque": torque + 0.02 * rng.standard_normal(len(time)), "velocity": velocity}
    comparison, tested = asymmetry(Recording("sine", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))
    assert Refits(comparison, POLICY).with_effect(tested) is None
    fitted = Refits(comparison, replace(POLICY, driving_friction=np.inf)).with_effect(tested)
    assert fitted is not None
    assert fitted.estimate.parameters["asymmetry.c"] > 0.4


@pytest.mark.parametrize(
    ("model", "values", "speed"),
    [
        ("coulomb-viscous+nonlinear-viscous", {"nonlinear-viscous.a": 0.0, "nonlinear-viscous.b": -0.2}, 5.8541),
        ("coulomb-viscous+nonlinear-viscous", {"nonlinear-viscous.a": 0.0, "nonlinear-viscous.b": 0.2}, None),
        ("coulomb-viscous+asymmetry", {"asymmetry.c": 0.0, "asymmetry.d": -1.1}, 10.0),
        ("coulomb-viscous+asymmetry", {"asymmetry.c": 0.0, "asymmetry.d": 1.1}, 10.0),
        ("coulomb-viscous+asymmetry", {"asymmetry.c": 0.0, "asymmetry.d": -1.01}, None),
        ("coulomb-viscous", {}, None),
    ],
)
def test_from_which_speed_a_friction_would_drive(model: str, values: dict[str, float], speed: float | None) -> None:
    """1 + ω − 0.2 ω² is zero at (1 + √1.8)/0.4, and 1 + ω − 1.1 ω at 10, one way or the other; 1 − 0.01 ω at 100."""
    comparison = compare(record(0.0), model, INERTIA)
    values = {**comparison.estimate.parameters, "K_v": 1.0, "K_c": 1.0, **values}
    given = replace(comparison, estimate=replace(comparison.estimate, parameters=values))
    expected = None if speed is None else pytest.approx(speed, rel=1e-3)
    assert drives_from(given) == expected
    document = comparison_document(given)
    words = error_words(document)
    assert document.friction_drives_from == expected
    assert ("would push, not brake" in words) == (speed is not None)


def test_what_is_no_friction_may_drive() -> None:
    comparison = compare(record(0.0, offset=5.0), "coulomb-viscous+torque-offset", INERTIA)
    assert comparison.estimate.parameters["torque-offset.tau_0"] == pytest.approx(5.0, rel=0.01)
    assert driving_share(comparison, 0.01) == 0.0


@pytest.mark.parametrize(("difference", "slope", "stays"), [(0.5, 0.1, True), (5.0, 0.0, False), (-5.0, 0.2, False)])
def test_an_asymmetry_of_more_than_the_friction_is_refused(difference: float, slope: float, stays: bool) -> None:
    comparison, tested = asymmetry(record(difference, slope))
    assert (Refits(comparison, POLICY).with_effect(tested) is not None) is stays
    assert Refits(comparison, replace(POLICY, driving_friction=np.inf)).with_effect(tested) is not None


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_a_load_is_not_named_as_a_friction(seed: int) -> None:
    """A torque of several times the friction is an offset, not friction that differs between the directions."""
    ladder = improve(record(0.0, offset=4.0, seed=seed), "coulomb-viscous", INERTIA)
    (finding,) = ladder.first.findings
    assert finding.names == ("torque-offset",)
    assert ladder.last.verdict == "adequate"


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_a_difference_within_the_friction_may_be_either(seed: int) -> None:
    ladder = improve(record(0.6, seed=seed), "coulomb-viscous", INERTIA)
    (finding,) = ladder.first.findings
    assert {"torque-offset", "asymmetry"} <= set(finding.names)


def test_the_slope_of_a_friction_is_taken_where_it_has_a_value() -> None:
    """A standard error of a speed that is many times the speed: less of it is no speed, and the torque no number.

    The friction that ages beside it is fitted to such numbers, too, where its beginning is sought.
    """
    comparison = compare(record(0.0), "coulomb-viscous+stribeck+rising-stiction", INERTIA)
    values = {**comparison.estimate.parameters, "stribeck.F_s": 1.0, "stribeck.omega_s": 0.1, "stribeck.delta": 1.3}
    values |= {"rising-stiction.F": 0.5, "rising-stiction.T": 0.2, "rising-stiction.x_s": 0.02}
    errors = {**dict.fromkeys(values, 0.0), "stribeck.omega_s": 30.0}
    found = replace(comparison.estimate, parameters=values, standard_errors=errors, covariance=None)
    assert driving_share(replace(comparison, estimate=found), 0.01) == 0.0
    braking = replace(found, parameters={**values, "K_v": 0.0, "K_c": 0.0, "stribeck.F_s": -1.0})
    sure, unsure = ({**errors, "stribeck.omega_s": error} for error in (1e-6, 30.0))
    shares = [
        driving_share(replace(comparison, estimate=replace(braking, standard_errors=e)), 0.01) for e in (sure, unsure)
    ]
    assert shares[0] > 2.0 * shares[1]
